// The API's page: /openapi.json shown by Swagger UI, whose requests go to the daemon that serves it.
import SwaggerUI from "swagger-ui-dist/swagger-ui-es-bundle.js";
import { adapt, unquote } from "./adapt.ts";
import type { Contract } from "./contract.ts";
import { makeExamples } from "./examples.ts";
import { keepMended } from "./mend.ts";
import "./style.css";

function element<Kind extends HTMLElement>(id: string): Kind {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as Kind;
}

function say(text: string): void {
  element("prepared").textContent = text;
}

/** Swagger UI is dark by a class of the document. */
function followSystem(): void {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const follow = (): unknown => document.documentElement.classList.toggle("dark-mode", system.matches);
  system.addEventListener("change", follow);
  follow();
}

async function show(): Promise<void> {
  const contract = (await (await fetch("/openapi.json")).json()) as Contract;
  adapt(contract);
  element("version").textContent = contract.info.version;
  const page = SwaggerUI({
    spec: contract,
    domNode: element("operations"),
    deepLinking: true,
    defaultModelsExpandDepth: -1,
    displayRequestDuration: true,
    docExpansion: "list",
    requestInterceptor: unquote,
    tryItOutEnabled: true,
    syntaxHighlight: { theme: "monokai" },
    validatorUrl: null,
  });
  keepMended(element("operations"));
  const button = element<HTMLButtonElement>("prepare");
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      const made = await makeExamples(contract, page.authSelectors.authorized().getIn(["key", "value"]));
      page.specActions.updateSpec(JSON.stringify(contract));
      say(`Made: ${made.join(", ")}.`);
    } catch (error) {
      say((error as Error).message);
    }
    button.disabled = false;
  });
}

followSystem();
show().catch((error: Error) => say(`The page could not be made: ${error.message}`));
