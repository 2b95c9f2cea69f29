// A form in a modal window: its fields, the author's name, and the error when it could not be submitted.
import type { ComponentChildren } from "preact";
import { useRef, useState } from "preact/hooks";
import { saveAuthorName, savedAuthorName } from "../data/author-name";
import { ApiError, type IdempotencyKeys } from "../data/http-client";
import { t } from "../messages/messages";
import { Dialog } from "./dialog";

interface Props {
  title: string;
  button: string;
  /** Whether the change is recorded under its author's name. */
  named?: boolean;
  /** Carry it out; an error that it throws is shown, and the window stays. */
  onSubmit: (form: FormData, keys: IdempotencyKeys) => Promise<void>;
  onClose: () => void;
  children?: ComponentChildren;
}

export function FormDialog({ title, button, named = true, onSubmit, onClose, children }: Props) {
  const [failure, setFailure] = useState<string | null>(null);
  const [busy, setBusy] = useState(false);
  const keys = useRef<IdempotencyKeys>(new Map());
  const submit = async (event: SubmitEvent) => {
    event.preventDefault();
    const form = new FormData(event.currentTarget as HTMLFormElement);
    if (named) saveAuthorName(author(form));
    setBusy(true);
    setFailure(null);
    try {
      await onSubmit(form, keys.current);
      onClose();
    } catch (error) {
      setFailure(error instanceof ApiError ? error.message : String(error));
    } finally {
      setBusy(false);
    }
  };
  return (
    <Dialog title={title} onClose={onClose}>
      <form onSubmit={submit}>
        {children}
        {named && (
          <label>
            {t("yourName")}
            <input name="by" required maxLength={120} autoComplete="name" defaultValue={savedAuthorName()} autofocus={savedAuthorName() === ""} />
          </label>
        )}
        {failure && (
          <p class="error" role="alert">
            {failure}
          </p>
        )}
        <p class="buttons">
          <button type="submit" class="strong" disabled={busy}>
            {busy ? "…" : button}
          </button>
          <button type="button" onClick={onClose}>
            {t("cancel")}
          </button>
        </p>
      </form>
    </Dialog>
  );
}

/** The name entered in a form. */
export function author(form: FormData): string {
  return String(form.get("by")).trim();
}

export function CommentField(props: { label?: string; required?: boolean; rows?: number; text?: string }) {
  return (
    <label>
      {props.label ?? t("comment")}
      <textarea name="comment" rows={props.rows ?? 3} maxLength={2000} required={props.required ?? false} defaultValue={props.text ?? ""} />
    </label>
  );
}
