// What a node or a connection is: parameters, ports, place in the file.

import { counted, short } from "./text.js";

const SHOWN = ["from", "to", "width", "delay_ticks", "file", "line", "column"];  // keys of a connection with own rows

export class Details {
  constructor(model) {
    this.model = model;
    this.panel = document.getElementById("details");
    this.title = document.getElementById("details-title");
    this.body = document.getElementById("details-body");
    document.getElementById("details-close").addEventListener("click", () => this.close());
    document.getElementById("panels").addEventListener("pointerdown", (event) => {
      if (!event.target.closest(".node, .edge")) {
        this.close();
      }
    });
  }

  close() {
    if (!this.panel.hidden) {
      this.panel.hidden = true;
      this.opener?.focus();
    }
  }

  open(kind, item) {
    this.opener = document.activeElement;
    this.body.replaceChildren();
    if (kind === "node") {
      this.node(item);
    } else {
      this.link(item);
    }
    this.panel.hidden = false;
    document.getElementById("details-close").focus();
  }

  node(name) {
    const { resolved } = this.model;
    const { node, simulator, ...parameters } = resolved.nodes[name] ?? {};
    this.title.textContent = name;
    this.table("", [[node ? "node" : "simulator", node ?? simulator ?? "–"], ["file", this.place(name)]]);
    this.table("Ports", this.ports(name));
    this.table("Parameters", Object.entries(parameters).map(([key, value]) => [key, written(value)]));
  }

  link(link) {
    const tick = this.model.resolved.tick_ns / 1e6;
    this.title.textContent = `${link.from} → ${link.to}`;
    for (const connection of link.connections) {
      this.table(`${connection.from} → ${connection.to}`, [
        ["kind", this.kind(connection.from)], ["width", counted(connection.width, "channel")],
        ["delay", `${connection.delay_ticks} ticks (${short(connection.delay_ticks * tick)} ms)`],
        ...Object.entries(connection).filter(([key]) => !SHOWN.includes(key)).map(([key, value]) => [key, written(value)]),
        ...(connection.line ? [["file", this.file(connection)]] : []),
      ]);
    }
  }

  kind(key) {
    const output = this.model.outputs.get(key);
    return output ? (output.kind === "spikes" ? "spikes" : "signal") : "not known";
  }

  ports(name) {
    const ports = new Map();
    for (const each of this.model.resolved.connections) {
      for (const [port, way, other] of [[each.to, "in", each.from], [each.from, "out", each.to]]) {
        if (port.startsWith(`${name}.`)) {
          const known = ports.get(port) ?? { way, width: each.width, others: [] };
          known.others.push(other);
          ports.set(port, known);
        }
      }
    }
    for (const output of this.model.outputs.values()) {
      if (output.node === name && !ports.has(output.key)) {
        ports.set(output.key, { way: "out", width: output.store.width, others: [] });
      }
    }
    return [...ports].map(([port, { way, width, others }]) => {
      const kind = way === "in" ? "input" : `output, ${this.kind(port)}`;
      const ends = others.length ? ` ${way === "in" ? "from" : "to"} ${others.join(", ")}` : "";
      return [port.slice(name.length + 1), `${kind} [${width}]${ends}`];
    });
  }

  place(name) {
    const { resolved } = this.model;
    return this.file(resolved.positions?.[name] ?? resolved.places?.[name] ?? {});
  }

  file({ file, line, column }) {
    const path = file ?? this.model.resolved.experiment_file ?? "–";
    return [path, line, column].filter((part) => part !== undefined).join(":");
  }

  table(title, rows) {
    if (!rows.length) {
      return;
    }
    if (title) {
      const heading = document.createElement("h3");
      heading.textContent = title;
      this.body.append(heading);
    }
    const table = document.createElement("table");
    for (const [key, value] of rows) {
      const row = table.insertRow(), head = document.createElement("th");
      head.textContent = key;
      row.append(head);
      row.insertCell().textContent = value;
    }
    this.body.append(table);
  }
}

/// Text of a parameter; JSON in it is laid out for reading.
function written(value) {
  let found = value;
  if (typeof value === "string" && /^\s*[[{]/.test(value)) {
    try {
      found = JSON.parse(value);
    } catch {
      return value;
    }
  }
  if (found === "" || found === null) {
    return "–";
  }
  const flatText = (each) => (typeof each === "string" ? each : JSON.stringify(each));
  const lines = Array.isArray(found) ? found.map(flatText)
    : typeof found === "object" ? Object.entries(found).map(([key, each]) => `${key}: ${flatText(each)}`) : [String(found)];
  const flat = Array.isArray(found) && found.every((each) => typeof each !== "object");
  const text = lines.join(flat ? ", " : "\n");
  return text.length > 4000 ? `${text.slice(0, 4000)} …` : text;
}
