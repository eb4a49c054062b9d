// Reads bags of ROS 2 with packages of other authors, and prints what is in them:
//
//   node ros2_check.mjs list FILE.mcap         per topic: name, type, number of messages, sums over their values
//   node ros2_check.mjs values FILE.mcap       a line of JSON for each message
import { createHash } from "node:crypto";
import { open, readFile } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { CdrReader, EncapsulationKind } from "@foxglove/cdr";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress as decompressZstd } from "fzstd";

/// Unpacks an LZ4 frame; the packages have no decoder for LZ4.
function unpackLz4(packed, size) {
  const out = new Uint8Array(Number(size));
  const view = new DataView(packed.buffer, packed.byteOffset, packed.byteLength);
  let at = 4, to = 0;
  const flags = packed[at];
  at += 2 + (flags & 8 ? 8 : 0) + (flags & 1 ? 4 : 0) + 1;
  for (;;) {
    const head = view.getUint32(at, true);
    at += 4;
    if (head === 0) return out;
    const length = head & 0x7fffffff, end = at + length;
    if (head & 0x80000000) {
      out.set(packed.subarray(at, end), to);
      to += length;
    } else {
      let i = at;
      while (i < end) {
        const token = packed[i++];
        let count = token >> 4;
        if (count === 15) for (let more = 255; more === 255; ) count += more = packed[i++];
        out.set(packed.subarray(i, i + count), to);
        to += count;
        i += count;
        if (i >= end) break;
        const offset = packed[i] | (packed[i + 1] << 8);
        i += 2;
        let match = (token & 15) + 4;
        if (match === 19) for (let more = 255; more === 255; ) match += more = packed[i++];
        for (; match > 0; --match, ++to) out[to] = out[to - offset];
      }
    }
    at = end + (flags & 16 ? 4 : 0);
  }
}

const decompressHandlers = { zstd: (packed) => decompressZstd(packed), lz4: unpackLz4 };

/// Numbers of 64 bits as decimal text and typed arrays as lists, so that other programs can compare them.
function plain(key, value) {
  if (typeof value === "bigint") return `${value}`;
  if (ArrayBuffer.isView(value)) return Array.from(value, (v) => (typeof v === "bigint" ? `${v}` : v));
  return value;
}

async function readMcap(path, visit) {
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  // The indexed reader uses the summary; the stream reader uses the chunks and checks their sums.
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  let streamed = 0;
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(new Uint8Array(await readFile(path)));
  for (let record; (record = stream.nextRecord()); ) if (record.type === "Message") ++streamed;
  if (!stream.done()) throw new Error("the stream has no end");
  const readers = new Map();
  let indexed = 0;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!readers.has(schema.id)) {
      const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
      readers.set(schema.id, new MessageReader(definitions));
    }
    if (new CdrReader(message.data).kind !== EncapsulationKind.CDR_LE) throw new Error("not little-endian CDR");
    visit(channel, schema, message, readers.get(schema.id).readMessage(message.data));
    ++indexed;
  }
  const stated = Number(reader.statistics.messageCount);
  if (indexed !== streamed || indexed !== stated) throw new Error(`${indexed}, ${streamed}, ${stated} messages`);
  await file.close();
}

const [command, path] = process.argv.slice(2);
if (command === "values") {
  await readMcap(path, (channel, schema, message, value) =>
    console.log(`${message.logTime} ${channel.topic} ${schema.name} ${JSON.stringify(value, plain)}`));
} else if (command === "list") {
  const topics = new Map();
  await readMcap(path, (channel, schema, message, value) => {
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
