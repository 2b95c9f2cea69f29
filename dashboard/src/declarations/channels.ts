// Written by `python -m service.commands.page_declarations` from service/delivery/channels.py; not to be changed here.

/** Ways in which people and programs are told of alerts. */
export const CHANNELS = [
  { kind: "webhook", title: "webhook" },
  { kind: "alertmanager", title: "Prometheus Alertmanager" },
  { kind: "email", title: "e-mail" },
  { kind: "zenoh", title: "the plant's own network (zenoh)" },
  { kind: "mqtt", title: "the plant's broker (MQTT)" },
] as const;

/** Forms of their addresses, in words. */
export const ADDRESS_FORMS = "a URL, or e-mail addresses with commas between; none for zenoh, mqtt";
