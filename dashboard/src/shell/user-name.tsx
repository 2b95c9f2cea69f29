// The user who is logged in, and the way out.
import { useStore } from "../browser/store";
import { currentUser, logOut } from "../data/session";

export function UserName() {
  const user = useStore(currentUser);
  if (user?.kind !== "session") return null;
  return (
    <span class="user-name">
      {user.name} ({user.role}){" "}
      <button type="button" class="quiet" onClick={() => void logOut()}>
        Log out
      </button>
    </span>
  );
}
