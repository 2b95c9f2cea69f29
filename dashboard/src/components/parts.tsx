// Small pieces that many views share: times, states, what to show while there is nothing.
import type { ComponentChildren } from "preact";
import type { Failure } from "../data/http-client";
import { connection } from "../data/connection";
import { clock, utc, when } from "../words/format";
import type { Answer } from "../data/resource";
import { useStore } from "../browser/store";

/** Local time, with UTC on hover. */
export function Time({ at }: { at: string | null | undefined }) {
  if (!at) return <>–</>;
  return (
    <time dateTime={at} title={utc(at)}>
      {when(at)}
    </time>
  );
}

export function Panel(props: { title: string; aside?: ComponentChildren; class?: string; children: ComponentChildren }) {
  return (
    <section class={`panel ${props.class ?? ""}`}>
      <header>
        <h2>{props.title}</h2>
        {props.aside}
      </header>
      {props.children}
    </section>
  );
}

export function Empty({ children }: { children: ComponentChildren }) {
  return <p class="empty">{children}</p>;
}

/** That a list has more than is shown. */
export function Cut({ shown, most, what = "newest", of = "" }: { shown: number; most: number; what?: string; of?: string }) {
  return shown < most ? null : (
    <p class="muted cut">
      The {what} {most}{of && ` ${of}`} are shown; there may be more.
    </p>
  );
}

export function Trouble({ failure }: { failure: Failure }) {
  return (
    <p class="trouble" role="alert">
      {said(failure)}
    </p>
  );
}

function said({ message, late }: Failure): string {
  return late ? `${message} It is asked again.` : message;
}

/** Beside data that grow old: of when they are, and why there are no newer ones. */
export function Aging({ answer: { data, failure, asOf } }: { answer: Answer<unknown> }) {
  const { state } = useStore(connection);
  if (data === undefined || asOf === undefined || !failure) return null;
  // What is wrong with the whole service is said once, above everything.
  if (state === "troubled" && failure.status >= 500) return null;
  return (
    <p class="trouble aging" role="status">
      As of {clock(asOf)}, nothing newer: {said(failure)}
    </p>
  );
}

/**
 * What an answer holds, and why that grows old where it does; or that it is on its way, or why there is none.
 * `lines` keeps the place free meanwhile.
 */
export function Shown<T>(props: { answer: Answer<T>; lines?: number; children: (data: T) => ComponentChildren }) {
  const { data, failure } = props.answer;
  if (data !== undefined) {
    return (
      <>
        <Aging answer={props.answer} />
        {props.children(data)}
      </>
    );
  }
  // That nobody answers is said once, above everything; it is asked again as soon as somebody does.
  if (failure?.own) return <Trouble failure={failure} />;
  return <div class="waiting" aria-busy="true" aria-label="loading" style={{ minHeight: `${(props.lines ?? 3) * 1.6}em` }} />;
}

const STATES: Record<string, [string, string]> = {
  stopped: ["■", "stopped"],
  "slow roll": ["◔", "slow roll"],
  slow_roll: ["◔", "slow roll"],
  "run-up": ["▲", "run-up"],
  "at speed": ["●", "at speed"],
  at_speed: ["●", "at speed"],
  "run-down": ["▼", "run-down"],
  trip: ["⏷", "trip"],
  unknown: ["○", "unknown"],
};

/** What a machine is doing, as a sign and a word. */
export function Mode({ state }: { state: string }) {
  const [glyph, word] = STATES[state] ?? ["○", state];
  return (
    <span class={`mode ${state === "trip" ? "trip" : ""}`}>
      <span aria-hidden="true">{glyph}</span> {word}
    </span>
  );
}

/** The worst first. */
export const SEVERITY_GLYPHS: Record<string, string> = { danger: "◆", alert: "▲", info: "●" };

/** A severity as a sign with its own shape and colour, and the word beside it where there is room. */
export function Severity(props: { severity: string; seen?: boolean; word?: boolean }) {
  const { severity, seen = false, word = true } = props;
  return (
    <span class={`severity ${severity} ${seen ? "seen" : ""}`} title={severity}>
      <span aria-hidden="true">{SEVERITY_GLYPHS[severity] ?? "●"}</span>
      <span class={word ? undefined : "hidden"}> {severity}</span>
    </span>
  );
}
