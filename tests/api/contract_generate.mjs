// Generates TypeScript from an OpenAPI document with one generator, and compiles it strictly. On
// failure prints the errors and exits with status 1.
//
//     node contract_generate.mjs NODE_MODULES GENERATOR DOCUMENT FOLDER
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { writeFileSync } from "node:fs";

const [modules, generator, document, folder] = process.argv.slice(2);
const require = createRequire(`${modules}/`);

function run(command, ...options) {
  execFileSync(process.execPath, [`${modules}/.bin/${command}`, ...options], { stdio: ["ignore", "inherit", "inherit"], cwd: folder });
}

const generators = {
  "openapi-typescript": () => run("openapi-typescript", document, "--output", `${folder}/api.ts`),
  "hey-api": () => {
    const settings = { input: document, output: `${folder}/made`, parser: { validate_EXPERIMENTAL: "strict" } };
    writeFileSync(`${folder}/settings.mjs`, `export default ${JSON.stringify(settings)};`);
    run("openapi-ts", "--file", `${folder}/settings.mjs`);
  },
  // Disables orval's own validation, because its rules (by IBM) do not support OpenAPI 3.1.
  orval: () => require("orval").generate({ input: { target: document }, output: { target: `${folder}/api.ts`, client: "fetch", mode: "single" } }, folder),
};

const compilerOptions = {
  strict: true, exactOptionalPropertyTypes: generator === "openapi-typescript", noEmit: true, skipLibCheck: true, types: [],
  target: "es2022", module: "nodenext", moduleResolution: "nodenext", lib: ["es2023", "dom", "dom.iterable"],
};

try {
  await generators[generator]();
  writeFileSync(`${folder}/tsconfig.json`, JSON.stringify({ compilerOptions, include: ["**/*.ts"] }));
  run("tsc", "--project", folder);
} catch (error) {
  console.error(error.message);
  process.exit(1);
}
