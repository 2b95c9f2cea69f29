// A form in front of the page: fields, who asks, and what the service answers.
import type { ComponentChildren } from "preact";
import { useRef, useState } from "preact/hooks";
import { Failure, type Attempt } from "../data/http-client";
import { Dialog } from "./dialog";
import { keepName, keptName } from "../data/author-name";

interface Props {
  title: string;
  button: string;
  /** Whether who asks is written down. */
  named?: boolean;
  /** Carry it out; what it throws is shown, and the window stays. */
  onSubmit: (form: FormData, attempt: Attempt) => Promise<void>;
  onClose: () => void;
  children?: ComponentChildren;
}

export function AskDialog({ title, button, named = true, onSubmit, onClose, children }: Props) {
  const [failure, setFailure] = useState<string | null>(null);
  const [busy, setBusy] = useState(false);
  const attempt = useRef<Attempt>(new Map());
  const submit = async (event: SubmitEvent) => {
    event.preventDefault();
    const form = new FormData(event.currentTarget as HTMLFormElement);
    if (named) keepName(String(form.get("by")).trim());
    setBusy(true);
    setFailure(null);
    try {
      await onSubmit(form, attempt.current);
      onClose();
    } catch (error) {
      setFailure(error instanceof Failure ? error.message : String(error));
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
            Your name
            <input name="by" required maxLength={120} autoComplete="name" defaultValue={keptName()} />
          </label>
        )}
        {failure && (
          <p class="trouble" role="alert">
            {failure}
          </p>
        )}
        <p class="buttons">
          <button type="submit" class="strong" disabled={busy}>
            {busy ? "…" : button}
          </button>
          <button type="button" onClick={onClose}>
            Cancel
          </button>
        </p>
      </form>
    </Dialog>
  );
}

export function Comment({ required = false }: { required?: boolean }) {
  return (
    <label>
      Comment
      <textarea name="comment" rows={3} maxLength={2000} required={required} />
    </label>
  );
}
