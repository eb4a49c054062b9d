// Reads MCAP files with packages of other authors, for the checks beside this file.
import { open, readFile } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
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

/// Reads an MCAP file twice, with its summary and without, and visits each message in the order of time.
/// `makeDecoder(channel, schema)`: gives the function that decodes the bytes of a message.
export async function readMcap(path, makeDecoder, visit) {
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
  const decoders = new Map();
  let indexed = 0;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!decoders.has(schema.id)) decoders.set(schema.id, makeDecoder(channel, schema));
    visit(channel, schema, message, decoders.get(schema.id)(message.data));
    ++indexed;
  }
  const stated = Number(reader.statistics.messageCount);
  if (indexed !== streamed || indexed !== stated) throw new Error(`${indexed}, ${streamed}, ${stated} messages`);
  await file.close();
}
