// The page's messages in its language. Every module that says something waits until they are there.
import type { ComponentChildren } from "preact";
import { CHANNEL_NAMES } from "../declarations/channels";
import { FINDING_NAMES } from "../declarations/findings";
import { en, type Key } from "./en";
import { locale, type Locale } from "./locale";

/** Catalogues beside the English one, loaded where they are wanted. */
const CATALOGUES: Record<Exclude<Locale, "en">, () => Promise<Partial<Record<Key, string>>>> = {
  de: async () => (await import("./de")).de,
};

async function catalogue(): Promise<Partial<Record<Key, string>>> {
  if (locale === "en") return en;
  try {
    return await CATALOGUES[locale]();
  } catch {
    return en; // A page in another language is better than none.
  }
}

const translated = await catalogue();
/** The language of the messages: English where the catalogue of the one that is wanted could not be loaded. */
export const shownLocale: Locale = translated === en ? "en" : locale;
document.documentElement.lang = shownLocale;

/** What a language lacks is said in English. */
const MESSAGES: Readonly<Record<string, string | undefined>> = { ...en, ...translated };
/** Names of what the service declares: findings and delivery channels. */
const DECLARED: Readonly<Record<string, string | undefined>> = { ...FINDING_NAMES[shownLocale], ...CHANNEL_NAMES[shownLocale] };
const PLACE = /\{(\w+)\}/;

type PlacesIn<Text extends string> = Text extends `${string}{${infer Name}}${infer Rest}` ? Name | PlacesIn<Rest> : never;
type Places<K extends Key> = PlacesIn<(typeof en)[K]>;
type Value = string | number | null | undefined | false;
type Values<K extends Key, V> = [Places<K>] extends [never] ? [] : [values: Record<Places<K>, V>];

/** A message with values in its places; null, undefined and false are empty. */
export function t<K extends Key>(key: K, ...[values]: Values<K, Value>): string {
  return partsOf<Value>(key, values).map((one) => one || one === 0 ? String(one) : "").join("");
}

/** A message with elements in its places. */
export function rich<K extends Key>(key: K, ...[values]: Values<K, ComponentChildren>): ComponentChildren {
  return partsOf<ComponentChildren>(key, values);
}

function partsOf<V>(key: Key, values: Record<string, V> = {}): (V | string)[] {
  return MESSAGES[key]!.split(PLACE).map((part, at) => (at % 2 === 0 ? part : (values[part] as V)));
}

/** Coefficients between angles and moments: `kφx` of `k_phix`. */
const ANGULAR = /^([kc][xy]?)_phi(?=[xy])/;

/** An identifier of the API in words: `run-up` of `run_up`; with spaces where there are no words for it. */
export function term(identifier: string): string {
  const name = identifier.replace(/[ -]/g, "_");
  return MESSAGES[`term.${name}`] ?? DECLARED[name] ?? identifier.replace(ANGULAR, "$1φ").replaceAll("_", " ");
}

const NUMBER = /^[−+-]?\d+\.\d+(e[+-]?\d+)?( %)?$/;
/** Form of a list, which any sentence may have by chance: it is one only of parts that are known, or names. */
const LIST = /^\{\w+\}(,| and| or| or with) \{\w+\}$/;
const NAME = /^\S+( %)?$/;
/** Places that one word fills, so that no list of sentences is taken for one sentence. */
const ONE_WORD = new Set(["id", "meant", "sent"]);

/** English sentences that the service stores, as forms with their words here; the longest come first. None where the page is English. */
const STORED_FORMS: [RegExp, string, boolean][] = Object.entries(await storedSentences())
  .sort(([one], [other]) => other.length - one.length)
  .map(([sentence, said]) => [storedForm(sentence), said, LIST.test(sentence)]);

/** Parts that were looked for, null where there are no words: those of a list are looked for again at each of its separators. */
const KNOWN_PARTS = new Map<string, string | null>();

async function storedSentences(): Promise<Readonly<Record<string, string>>> {
  if (shownLocale === "en") return {};
  try {
    return (await import("../declarations/stored-sentences")).STORED_SENTENCES[shownLocale] ?? {};
  } catch {
    return {}; // English sentences in a page of another language are better than no page.
  }
}

/** Names of parameters within a sentence: `coupling.C1.cxy`, `disc.D1.unbalance.real`. */
const PARAMETER = /\b(bearing|coupling|disc|material|pedestal|probe|seal|shaft|static_load)\.([\w-]+)\.([a-z]\w*)(?:\.(real|imaginary))?/g;

/** Unit of speeds in sentences that earlier releases stored. */
const FORMER_UNIT = /(?<=\d) rpm\b/g;
const MICROMETRES = /(\d+(?:[.,]\d+)?(?:e[+-]?\d+)?) µm(?! pp)/g;

/** Lengths of a sentence in another unit than the micrometres that it tells. */
function inLengthUnit(sentence: string, { label, factor }: { label: string; factor: number }): string {
  if (factor === 1) return sentence;
  return sentence.replace(MICROMETRES, (_, digits: string) => `${(Number(digits.replace(",", ".")) * factor).toFixed(2).replace(".", t("decimalMark"))} ${label}`);
}

/** A sentence that the service has stored in English, in the page's language as far as there are words for its parts. length: unit of its lengths. */
export function stored(sentence: string, length = { label: "µm", factor: 1 }): string {
  return inLengthUnit(translatedSentence(sentence.replace(FORMER_UNIT, " r/min")), length);
}

function translatedSentence(sentence: string): string {
  return sentence.split("; ").map(storedPart).join("; ").replace(PARAMETER, (_, kind: string, id: string, quantity: string, component?: string) =>
    `${term(kind)} ${id} ${term(quantity)}${component ? `, ${t(component === "real" ? "realPart" : "imaginaryPart")}` : ""}`);
}

function storedForm(text: string): RegExp {
  const parts = text.split(PLACE).map((part, at) => (at % 2 === 0 ? part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&") : `(?<${part}>${ONE_WORD.has(part) ? "\\S+" : ".+"})`));
  return new RegExp(`^${parts.join("")}$`);
}

function storedPart(part: string): string {
  return knownPart(part) ?? part;
}

function knownPart(part: string): string | null {
  let known = KNOWN_PARTS.get(part);
  if (known === undefined) {
    known = soughtPart(part);
    KNOWN_PARTS.set(part, known);
  }
  return known;
}

function soughtPart(part: string): string | null {
  if (NUMBER.test(part)) return part.replace(".", t("decimalMark"));
  for (const [form, said, isList] of STORED_FORMS) {
    const found = form.exec(part);
    if (!found) continue;
    const places = found.groups ?? {};
    if (isList && !Object.values(places).every((one) => knownPart(one) !== null || NAME.test(one))) continue;
    return said.split(PLACE).map((one, at) => (at % 2 === 0 ? one : storedPart(places[one]!))).join("");
  }
  return null;
}
