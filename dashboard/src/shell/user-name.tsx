// The user who is logged in, and the way out.
import { useStore } from "../browser/store";
import { currentUser, logOut } from "../data/session";
import { t, term } from "../messages/messages";

export function UserName() {
  const user = useStore(currentUser);
  if (user?.kind !== "session") return null;
  return (
    <span class="user-name">
      {user.name} ({term(user.role)}){" "}
      <button type="button" class="quiet" onClick={() => void logOut()}>
        {t("logOut")}
      </button>
    </span>
  );
}
