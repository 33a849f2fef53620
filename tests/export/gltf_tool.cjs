// Other people's programs look at a GLB file. MESOCELL_GLTF_TOOLS is a folder with node_modules, of
// gltf-validator, @gltf-transform/core, @gltf-transform/extensions and draco3dgltf.
//   node gltf_tool.cjs validate FILE   prints the number of errors, of warnings, and each issue
//   node gltf_tool.cjs decode FILE     prints of each mesh "mesh VERTICES TRIANGLES", of each attribute
//                                      "attribute NAME", and of each triangle nine coordinates
//   node gltf_tool.cjs check           exits with 0 if all is there
'use strict';
const fs = require('fs');
const path = require('path');
const { createRequire } = require('module');

const tools = process.env.MESOCELL_GLTF_TOOLS;
if (!tools) process.exit(2);
const from = createRequire(path.join(tools, 'any.cjs'));

async function validate(file) {
  const report = await from('gltf-validator').validateBytes(new Uint8Array(fs.readFileSync(file)));
  console.log(report.issues.numErrors);
  console.log(report.issues.numWarnings);
  for (const m of report.issues.messages) console.log(m.severity, m.code, m.pointer, m.message);
}

async function decode(file) {
  const { NodeIO } = from('@gltf-transform/core');
  const { ALL_EXTENSIONS } = from('@gltf-transform/extensions');
  const draco = await from('draco3dgltf').createDecoderModule();
  const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'draco3d.decoder': draco });
  const document = await io.readBinary(new Uint8Array(fs.readFileSync(file)));
  const lines = [];
  for (const mesh of document.getRoot().listMeshes())
    for (const primitive of mesh.listPrimitives()) {
      const positions = primitive.getAttribute('POSITION').getArray();
      const indices = primitive.getIndices().getArray();
      lines.push(`mesh ${positions.length / 3} ${indices.length / 3}`);
      for (const name of primitive.listSemantics()) lines.push(`attribute ${name}`);
      for (let k = 0; k < indices.length; k += 3) {
        const corners = [];
        for (let c = 0; c < 3; ++c)
          for (let a = 0; a < 3; ++a) corners.push(positions[3 * indices[k + c] + a]);
        lines.push(corners.join(' '));
      }
    }
  console.log(lines.join('\n'));
}

async function main() {
  const [what, file] = process.argv.slice(2);
  if (what === 'validate') return validate(file);
  if (what === 'decode') return decode(file);
  for (const name of ['gltf-validator', '@gltf-transform/core', '@gltf-transform/extensions', 'draco3dgltf'])
    from(name);
}
main().catch((error) => {
  console.error(error);
  process.exit(1);
});
