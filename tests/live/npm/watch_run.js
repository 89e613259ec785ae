// Watches a run by @foxglove/ws-protocol: waits for a laser scan, sets a parameter, and prints as JSON
// {channels: topics, beams, parameter: the value that the server then has}.

import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg-serialization";
import protocol from "@foxglove/ws-protocol";
import { WebSocket } from "ws";

const { FoxgloveClient } = protocol;
const [url, name, value] = process.argv.slice(2);
const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const topics = [];
let reader = null, beams = null;

client.on("error", (error) => { throw error; });
client.on("advertise", (channels) => {
  topics.push(...channels.map((channel) => channel.topic));
  const scan = channels.find((channel) => channel.topic === "/scan");
  if (scan && !reader) {
    reader = new MessageReader(parse(scan.schema));
    client.subscribe(scan.id);
  }
});
client.on("message", ({ data }) => {
  if (beams === null) {
    beams = reader.readMessage(data).ranges.length;
    client.setParameters([{ name, value: Number(value) }], "set");
    client.getParameters([name], "get");
  }
});
client.on("parameterValues", ({ parameters, id }) => {
  if (id === "get") {
    process.stdout.write(JSON.stringify({ channels: topics, beams, parameters }));
    client.close();
  }
});
