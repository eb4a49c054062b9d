// Reads a run as an MCAP file with a package of other authors, and checks every message by the schema in the file:
//
//   node foxglove_check.mjs FILE.mcap     per topic: name, schema, number of messages, first and last time
import { readMcap } from "./mcap_reading.mjs";

/// Throws where a value is not what its JSON schema says.
function check(value, schema, where) {
  const fail = (what) => { throw new Error(`${where}: ${what}`); };
  if (schema.type === "object") {
    if (typeof value !== "object" || value === null || Array.isArray(value)) fail("no object");
    for (const name of schema.required ?? []) if (!(name in value)) fail(`no ${name}`);
    for (const [name, part] of Object.entries(value)) {
      if (!(name in schema.properties)) fail(`${name} is not in the schema`);
      check(part, schema.properties[name], `${where}.${name}`);
    }
  } else if (schema.type === "array") {
    if (!Array.isArray(value)) fail("no list");
    value.forEach((part, i) => check(part, schema.items, `${where}[${i}]`));
  } else if (schema.type === "integer") {
    if (!Number.isInteger(value)) fail("no whole number");
  } else if (schema.type === "number") {
    if (!Number.isFinite(value)) fail("no number");
  } else if (schema.type === "string") {
    if (typeof value !== "string") fail("no text");
    if (schema.contentEncoding === "base64" && Buffer.from(value, "base64").toString("base64") !== value)
      fail("no base64");
  } else {
    fail(`unknown type ${schema.type}`);
  }
}

function jsonDecoder(channel, schema) {
  if (channel.messageEncoding !== "json" || schema.encoding !== "jsonschema") throw new Error("not in JSON");
  const rules = JSON.parse(new TextDecoder().decode(schema.data));
  return (data) => {
    const value = JSON.parse(new TextDecoder().decode(data));
    check(value, rules, channel.topic);
    return value;
  };
}

const topics = new Map();
let last = 0n;
await readMcap(process.argv[2], jsonDecoder, (channel, schema, message, value) => {
  const { sec, nsec } = value.timestamp;
  const time = BigInt(sec) * 1000000000n + BigInt(nsec);
  if (message.logTime !== time) throw new Error(`${channel.topic}: ${message.logTime} ns outside, ${time} ns inside`);
  if (time < last) throw new Error(`${channel.topic}: back in time`);
  last = time;
  const name = `${channel.topic} ${schema.name}`;
  const topic = topics.get(name) ?? { count: 0, first: time };
  topics.set(name, { ...topic, count: topic.count + 1, last: time });
});
for (const [name, { count, first, last }] of [...topics].sort()) console.log(`${name} ${count} ${first} ${last}`);
