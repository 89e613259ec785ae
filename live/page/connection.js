// The Foxglove WebSocket protocol (client). Reconnects every second.

const PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const RETRY_MS = 1000;
const SUBSCRIPTIONS = 200;  // per message: the server reads at most 16 KB
const SILENT_MS = 10_000;  // the server sends time and status many times a second

export class Connection {
  /// handlers: opened, closed, info, advertised, unadvertised, unsubscribed, data, time, parameters, notice
  constructor(url, handlers) {
    this.url = url;
    this.handlers = handlers;
    this.state = "connecting";  // "connected", "lost"
    this.channels = new Map();  // by id
    this.wanted = () => false;
    this.clear();
  }

  clear() {
    this.channels.clear();
    this.subscriptions = new Map();  // channel by subscription
    this.subscribed = new Map();  // subscription by id of the channel
    this.lastMessage = performance.now();
  }

  start() {
    const socket = new WebSocket(this.url, PROTOCOLS);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.clear();
      this.state = "connected";
      this.handlers.opened();
      // All, also those of processes that begin later.
      this.send({ op: "subscribeParameterUpdates", parameterNames: [] });
      this.send({ op: "getParameters", parameterNames: [], id: "all" });
    };
    socket.onmessage = (event) => {
      this.lastMessage = performance.now();
      if (typeof event.data === "string") {
        this.receiveText(event.data);
      } else {
        this.receiveBinary(event.data);
      }
    };
    socket.onclose = () => {
      if (this.socket !== socket) {
        return;
      }
      const first = this.state === "connected";
      this.state = "lost";
      if (first || !this.lostAt) {
        this.lostAt = performance.now();
      }
      this.handlers.closed();
      setTimeout(() => this.start(), RETRY_MS);
    };
    clearInterval(this.watch);
    this.watch = setInterval(() => this.checkSilence(), 500);
  }

  /// A cable that was pulled out closes no socket.
  checkSilence() {
    if (this.state === "connected" && performance.now() - this.lastMessage > SILENT_MS) {
      const socket = this.socket;
      socket.onclose({});
      this.socket = null;
      socket.close();
    }
  }

  receiveText(text) {
    let message;
    try {
      message = JSON.parse(text);
    } catch {
      this.handlers.notice(1, "the server sent text that is not JSON");
      return;
    }
    switch (message.op) {
      case "serverInfo": this.handlers.info(message); break;
      case "advertise":
        message.channels.forEach((channel) => this.channels.set(channel.id, channel));
        this.handlers.advertised(message.channels);
        break;
      case "unadvertise":
        message.channelIds.forEach((id) => this.forget(id));
        this.handlers.unadvertised();
        break;
      case "parameterValues": this.handlers.parameters(message.parameters); break;
      case "status": this.handlers.notice(message.level, message.message); break;
      default: break;
    }
  }

  receiveBinary(buffer) {
    const view = new DataView(buffer);
    const seconds = (at) => (view.getUint32(at, true) + 4294967296 * view.getUint32(at + 4, true)) * 1e-9;
    const op = view.getUint8(0);
    if (op === 1) {
      const channel = this.subscriptions.get(view.getUint32(1, true));
      if (channel) {
        this.handlers.data(channel, seconds(5), new Uint8Array(buffer, 13));
      }
    } else if (op === 2) {
      this.handlers.time(seconds(1));
    }
  }

  forget(id) {
    this.channels.delete(id);
    this.subscriptions.delete(this.subscribed.get(id));
    this.subscribed.delete(id);
  }

  /// Subscribes to the channels for which `wanted` is true, and ends the other subscriptions.
  update(wanted) {
    const added = [], removed = [];
    for (const channel of this.channels.values()) {
      const present = this.subscribed.has(channel.id);
      if (wanted(channel) && !present) {
        this.next = (this.next ?? 0) + 1;
        this.subscribed.set(channel.id, this.next);
        this.subscriptions.set(this.next, channel);
        added.push({ id: this.next, channelId: channel.id });
      } else if (!wanted(channel) && present) {
        removed.push(this.subscribed.get(channel.id));
        this.handlers.unsubscribed(channel);
        this.subscriptions.delete(this.subscribed.get(channel.id));
        this.subscribed.delete(channel.id);
      }
    }
    for (let i = 0; i < added.length; i += SUBSCRIPTIONS) {
      this.send({ op: "subscribe", subscriptions: added.slice(i, i + SUBSCRIPTIONS) });
    }
    for (let i = 0; i < removed.length; i += SUBSCRIPTIONS) {
      this.send({ op: "unsubscribe", subscriptionIds: removed.slice(i, i + SUBSCRIPTIONS) });
    }
  }

  setParameter(name, value) {
    return this.send({ op: "setParameters", parameters: [{ name, value }], id: name });
  }

  /// False when there is no connection.
  send(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) {
      return false;
    }
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
