// Written by `python -m service.commands.page_declarations` from service/delivery/channels.py; not to be changed here.

/** Ways in which people and programs are told of alerts; reports: whether reports of machines go there. */
export const CHANNELS = [
  { kind: "webhook", reports: false },
  { kind: "alertmanager", reports: false },
  { kind: "email", reports: true },
  { kind: "zenoh", reports: false },
  { kind: "mqtt", reports: false },
] as const;

/** Their names, by language. */
export const CHANNEL_NAMES = {
  en: {"webhook": "webhook", "alertmanager": "Prometheus Alertmanager", "email": "e-mail", "zenoh": "the plant's own network (zenoh)", "mqtt": "the plant's broker (MQTT)"},
  de: {"webhook": "Webhook", "alertmanager": "Prometheus Alertmanager", "email": "E-Mail", "zenoh": "das eigene Netz der Anlage (zenoh)", "mqtt": "der Broker der Anlage (MQTT)"},
};

/** Forms of their addresses in words, by language. */
export const ADDRESS_FORMS = {
  en: "a URL, or e-mail addresses with commas between; none for zenoh, mqtt",
  de: "eine URL oder E-Mail-Adressen mit Kommas dazwischen; keine für zenoh, mqtt",
};
