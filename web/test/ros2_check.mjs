// Reads bags of ROS 2 with packages of other authors, and prints what is in them:
//
//   node ros2_check.mjs list FILE.mcap         per topic: name, type, number of messages, sums over their values
//   node ros2_check.mjs values FILE.mcap       a line of JSON for each message
import { createHash } from "node:crypto";
import { CdrReader, EncapsulationKind } from "@foxglove/cdr";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { readMcap } from "./mcap_reading.mjs";

/// Numbers of 64 bits as decimal text and typed arrays as lists, so that other programs can compare them.
function plain(key, value) {
  if (typeof value === "bigint") return `${value}`;
  if (ArrayBuffer.isView(value)) return Array.from(value, (v) => (typeof v === "bigint" ? `${v}` : v));
  return value;
}

function cdrDecoder(channel, schema) {
  const reader = new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true }));
  return (data) => {
    if (new CdrReader(data).kind !== EncapsulationKind.CDR_LE) throw new Error("not little-endian CDR");
    return reader.readMessage(data);
  };
}

const [command, path] = process.argv.slice(2);
if (command === "values") {
  await readMcap(path, cdrDecoder, (channel, schema, message, value) =>
    console.log(`${message.logTime} ${channel.topic} ${schema.name} ${JSON.stringify(value, plain)}`));
} else if (command === "list") {
  const topics = new Map();
  await readMcap(path, cdrDecoder, (channel, schema, message, value) => {
    const name = `${channel.topic} ${schema.name}`;
    if (!topics.has(name)) topics.set(name, { count: 0, sum: createHash("md5") });
    const topic = topics.get(name);
    ++topic.count;
    topic.sum.update(JSON.stringify(value, plain));
  });
  for (const [name, { count, sum }] of [...topics].sort()) console.log(`${name} ${count} ${sum.digest("hex")}`);
} else {
  throw new Error(`unknown command ${command}`);
}
