// Prints what @mcap/core reads in a file, as JSON: {whole, attachments, messages: number by topic and node,
// spikes: {number, sum of times, sum of channels} by topic}. A file without an end is read up to where it breaks off.

import { readFile } from "node:fs/promises";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";

const bytes = await readFile(process.argv[2]);
const decompressHandlers = await loadDecompressHandlers();
const found = { whole: false, attachments: [], messages: {}, spikes: {} };
const channels = new Map(), schemas = new Map(), readers = new Map();

function take(record) {
  if (record.type === "Schema") {
    schemas.set(record.id, record);
  } else if (record.type === "Channel") {
    channels.set(record.id, record);
  } else if (record.type === "Message") {
    const { topic, metadata, schemaId } = channels.get(record.channelId);
    const key = `${topic} ${metadata.get("spikeloop_node")}`;
    found.messages[key] = (found.messages[key] ?? 0) + 1;
    if (schemas.get(schemaId).name === "spikeloop/msg/Spikes") {
      takeSpikes(topic, record, schemas.get(schemaId));
    }
  }
}

function takeSpikes(topic, { data }, schema) {
  if (!readers.has(schema.id)) {
    readers.set(schema.id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  }
  const { times, channels: neurons } = readers.get(schema.id).readMessage(data);
  const sums = found.spikes[topic] ?? { number: 0, times: 0n, channels: 0 };
  found.spikes[topic] = {
    number: sums.number + times.length,
    times: times.reduce((sum, each) => sum + each, sums.times),
    channels: neurons.reduce((sum, each) => sum + each, sums.channels),
  };
}

const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
};
try {
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  found.whole = true;
  reader.schemasById.forEach(take);
  reader.channelsById.forEach(take);
  for await (const message of reader.readMessages()) {
    take(message);
  }
  for await (const attachment of reader.readAttachments()) {
    found.attachments.push(attachment.name);
  }
} catch (error) {
  if (found.whole) {
    throw error;
  }
  const reader = new McapStreamReader({ decompressHandlers });
  reader.append(bytes);
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    take(record);
  }
}
process.stdout.write(JSON.stringify(found, (_, value) => (typeof value === "bigint" ? String(value) : value)));
