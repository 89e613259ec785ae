// The numbers at the top, and the line that says what stops the robot.

import { counted, fixed, setText, short } from "./text.js";

const RANKS = { ok: 0, info: 1, warning: 2, error: 3 };
const NOTICE_MS = 12_000;
const OLD_S = 1;

export class Status {
  constructor(model, connection) {
    this.model = model;
    this.connection = connection;
    this.banner = document.getElementById("banner");
    this.text = document.getElementById("banner-text");
    this.noticeAt = -Infinity;
    this.results = "";
    this.state = { level: "info", text: "" };
  }

  /// A message of the server. level: 0 info, 1 warning, 2 error.
  notice(level, text) {
    this.noticeAt = performance.now();
    const element = document.getElementById("notice");
    element.textContent = `${["", "warning: ", "error: "][level] ?? ""}${text}`;
    element.title = text;
  }

  draw() {
    const summary = this.model.summary();
    this.drawNumbers(summary);
    this.state = this.find(summary);
    const { level, text, title } = this.state;
    this.banner.dataset.level = level;
    setText(this.text, text);
    this.text.title = title ?? text;
    if (performance.now() - this.noticeAt > NOTICE_MS) {
      setText(document.getElementById("notice"), "");
    }
  }

  drawNumbers(summary) {
    const { model } = this;
    this.number("simulated", `${fixed(summary.simulated, 2)} s`);
    const factor = summary.factor < 10 ? fixed(summary.factor, 3) : short(summary.factor);
    this.number("factor", summary.paused && !summary.ended ? "paused" : `${factor} ×`);
    const overruns = summary.known ? summary.overruns.toLocaleString("en") : "–";
    this.number("overruns", overruns, summary.overruns > 0 ? "warning" : "");
    const sorted = Float64Array.from(model.latencies).sort();
    document.getElementById("latency-cell").hidden = sorted.length === 0;
    const count = sorted.length;
    this.latency = count ? { median: quantile(sorted, 0.5), p99: quantile(sorted, 0.99), count } : null;
    if (this.latency) {
      this.number("latency", `${fixed(this.latency.median, 2)} · ${fixed(this.latency.p99, 2)} ms`);
    }
    this.age = model.dataAt === null ? NaN : (performance.now() - model.dataAt) / 1000;
    const old = this.age > OLD_S && !summary.paused && !summary.ended;
    this.number("age", age(this.age), old ? "warning" : "");
    this.drawLost(summary);
  }

  /// Bytes that the server lost, messages that it or the page left out.
  drawLost({ lost, dropped }) {
    const { leftOut, errors } = this.model;
    const messages = dropped + leftOut;
    const text = lost ? `${bytes(lost)}${messages ? ` + ${messages}` : ""}` : String(messages);
    this.number("lost", text, lost || dropped || errors.length ? "warning" : "");
    document.getElementById("lost-cell").title = [`Lost before the server read it: ${bytes(lost)}`,
      `Lost because this page was slow: ${counted(dropped, "message")}`, `Left out by the page: ${counted(leftOut, "message")}`,
      "The run itself loses nothing.", ...errors].join("\n");
  }

  number(id, text, level = "") {
    const element = document.getElementById(id);
    setText(element, text);
    if (element.dataset.level !== level) {
      element.dataset.level = level;
    }
  }

  /// {level, text}: the most important first.
  find(summary) {
    const { connection, model } = this;
    if (connection.state !== "connected") {
      return this.unconnected(summary);
    }
    if (summary.ended) {
      return { level: "info", text: `The run has ended at ${fixed(summary.simulated, 2)} s.${this.results}` };
    }
    const pressed = model.parameters.get("run.stop") === true;
    const several = summary.commands.length > 1;
    const found = summary.commands.map(({ node, level, text }) => ({ level, text: several ? `${node}: ${text}` : text }));
    found.sort((a, b) => (RANKS[b.level] ?? 3) - (RANKS[a.level] ?? 3));
    const bad = found.filter((each) => each.level !== "ok");
    const told = bad.some((each) => each.text.includes("STOP"));
    const parts = [pressed && !told ? "STOP is pressed in a live view." : "", ...bad.map((each) => sentence(each.text)),
                   summary.paused ? "The run is paused." : ""].filter(Boolean);
    if (parts.length) {
      const level = pressed || bad.some((each) => each.level === "error") ? "error" : bad.length ? "warning" : "info";
      return { level, text: parts.join("  ") };
    }
    if (found.length) {
      return { level: "ok", text: sentence(found[0].text || "the robot is driven by the network") };
    }
    const running = model.recording ? "Recording of a run." : "Running.";
    return { level: "info", text: summary.known ? running : "Connected; no status yet." };
  }

  unconnected(summary) {
    const { connection, model } = this;
    const never = model.dataAt === null && !summary.known;
    if (summary.ended) {
      const when = fixed(summary.simulated, 2);
      return { level: "info", text: `The run has ended at ${when} s, and its server, too.${this.results}` };
    }
    if (connection.state === "connecting" && never && !connection.lostAt) {
      return { level: "info", text: "Connecting …" };
    }
    if (never) {
      return { level: "error", text: `No connection to ${location.host}. Trying again every second.` };
    }
    const time = new Date(performance.timeOrigin + connection.lostAt).toTimeString().slice(0, 8);
    const stop = model.stopWaits ? "STOP is sent with the next connection" : "STOP cannot be sent";
    return { level: "error", text: `Connection lost at ${time}: the values are old. ${stop}. Trying again every second.` };
  }

  /// Of summary.json, when the run has ended.
  showResults(results) {
    const parts = [["distance_m", (v) => `${fixed(v, 2)} m driven`], ["collisions", (v) => counted(v, "collision")],
                   ["coverage", (v) => `${Math.round(100 * v)} % of the free area covered`],
                   ["stopped_s", (v) => (v > 0 ? `stopped for ${fixed(v, 1)} s` : "")]]
      .map(([key, text]) => (typeof results?.[key] === "number" ? text(results[key]) : "")).filter(Boolean);
    this.results = parts.length ? `  ${parts.join("  ·  ")}` : "";
  }
}

function sentence(text) {
  const whole = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(whole) ? whole : `${whole}.`;
}

function quantile(sorted, part) {
  return sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];
}

function age(seconds) {
  return Number.isNaN(seconds) ? "–" : seconds < 1 ? `${Math.round(seconds * 1000)} ms` : `${fixed(seconds, 1)} s`;
}

function bytes(count) {
  return count >= 1e6 ? `${fixed(count / 1e6, 1)} MB` : count >= 1e3 ? `${fixed(count / 1e3, 1)} kB` : `${count} B`;
}
