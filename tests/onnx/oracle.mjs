// What ONNX Runtime makes of models: one JSON object per line in, one out. `node oracle.mjs FOLDER`, where FOLDER/node_modules has
// onnxruntime-node.
import { createRequire } from 'node:module';
import { createInterface } from 'node:readline';
import { join, resolve } from 'node:path';

const ort = createRequire(join(resolve(process.argv[2]), 'x.js'))('onnxruntime-node');

async function answer({ model, shape, frames, output }) {
  const bytes = Buffer.from(model, 'base64');
  const session = await ort.InferenceSession.create(new Uint8Array(bytes), { intraOpNumThreads: 1, logSeverityLevel: 4 });
  const outputs = [];
  for (const text of frames) {
    const frame = Buffer.from(text, 'base64');
    const values = new Float32Array(frame.buffer.slice(frame.byteOffset, frame.byteOffset + frame.length));
    const found = await session.run({ [session.inputNames[0]]: new ort.Tensor('float32', values, shape) }, [output]);
    outputs.push(Array.from(found[output].data, String)); // JSON has no NaN
  }
  await session.release();
  return { outputs };
}

for await (const line of createInterface({ input: process.stdin })) {
  let found;
  try {
    found = await answer(JSON.parse(line));
  } catch (error) {
    found = { error: String(error.message ?? error) };
  }
  process.stdout.write(JSON.stringify(found) + '\n');
}
