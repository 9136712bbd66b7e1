// Lints an OpenAPI document by all rules of Redocly's linter. Each violation is an error. Prints a
// line for each fault.
//
//     node contract_lint.mjs NODE_MODULES DOCUMENT
import { createRequire } from "node:module";

const [modules, document] = process.argv.slice(2);
const { createConfig, lint } = createRequire(`${modules}/`)("@redocly/openapi-core");

const problems = await lint({ ref: document, config: await createConfig({ extends: ["recommended-strict"] }) });
for (const { ruleId, message, location } of problems) {
  console.log(`${ruleId}: ${location.map(({ pointer }) => pointer).join(", ")}: ${message.replace(/\s+/g, " ").slice(0, 300)}`);
}
