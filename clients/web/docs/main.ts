// The API's page: /openapi.json shown by Swagger UI, whose requests go to the daemon that serves it.
import SwaggerUI from "swagger-ui-dist/swagger-ui-es-bundle.js";
import type { Contract } from "./contract.ts";
import { makeExamples } from "./examples.ts";
import "./style.css";

function element<Kind extends HTMLElement>(id: string): Kind {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as Kind;
}

function say(text: string): void {
  element("prepared").textContent = text;
}

/** Swagger UI fills in every example, and queries should be answered at once as long as nobody asks for a job. */
async function readContract(): Promise<Contract> {
  const contract = (await (await fetch("/openapi.json")).json()) as Contract;
  delete contract.components.parameters["Prefer"]!.example;
  return contract;
}

async function show(): Promise<void> {
  const contract = await readContract();
  const page = SwaggerUI({
    spec: contract,
    domNode: element("operations"),
    deepLinking: true,
    defaultModelsExpandDepth: -1,
    displayRequestDuration: true,
    docExpansion: "list",
    tryItOutEnabled: true,
    validatorUrl: null,
  });
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

show().catch((error: Error) => say(`The page could not be made: ${error.message}`));
