// Written by `python -m service.commands.page_declarations` from service/delivery/channels.py; not to be changed here.

/** Ways in which people and programs are told of alerts; reports: whether reports of machines go there. */
export const CHANNELS = [
  { kind: "webhook", title: "webhook", reports: false },
  { kind: "alertmanager", title: "Prometheus Alertmanager", reports: false },
  { kind: "email", title: "e-mail", reports: true },
  { kind: "zenoh", title: "the plant's own network (zenoh)", reports: false },
  { kind: "mqtt", title: "the plant's broker (MQTT)", reports: false },
] as const;

/** Forms of their addresses, in words. */
export const ADDRESS_FORMS = "a URL, or e-mail addresses with commas between; none for zenoh, mqtt";
