// What an address names and there is not, in a person's words, with the way on.
import { link } from "../browser/router";
import { t } from "../messages/messages";

function Missing({ words, place, name }: { words: string; place: string; name: string }) {
  return (
    <>
      <p class="error" role="alert">
        {words}
      </p>
      <p>
        <a href={place}>{name}</a>
      </p>
    </>
  );
}

export function MissingAlert({ id }: { id: string }) {
  return <Missing words={t("thereIsNoAlert", { alert: id })} place={link(["alerts"])} name={t("allAlerts")} />;
}

export function MissingMachine({ id }: { id: string }) {
  return <Missing words={t("thereIsNoMachine", { machine: id })} place={link([])} name={t("toTheFleet")} />;
}
