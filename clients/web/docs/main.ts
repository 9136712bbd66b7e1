// The API page: Swagger UI shows /openapi.json and sends requests to the daemon of the page.
import SwaggerUI from "swagger-ui-dist/swagger-ui-es-bundle.js";
import { adapt, unquote } from "./adapt.ts";
import type { Contract } from "./contract.ts";
import { Examples } from "./examples.ts";
import { keepMended } from "./mend.ts";
import "./style.css";

function element<Kind extends HTMLElement>(id: string): Kind {
  const found = document.getElementById(id);
  if (!found) throw new Error(`The page has no element #${id}.`);
  return found as Kind;
}

function say(text: string): void {
  element("prepared").textContent = text;
}

/** Sets the class that makes Swagger UI dark while the system's theme is dark. */
function followSystem(): void {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const follow = (): unknown => document.documentElement.classList.toggle("dark-mode", system.matches);
  system.addEventListener("change", follow);
  follow();
}

/** Hides the conventions of the API, because they are long. A button shows them. */
function foldConventions(): void {
  const button = element<HTMLButtonElement>("conventions");
  button.addEventListener("click", () => {
    const isShown = element("operations").classList.toggle("with-conventions");
    button.setAttribute("aria-expanded", String(isShown));
  });
}

interface Request {
  url: string;
  method?: string;
  loadSpec?: boolean;
  body?: unknown;
}

async function show(): Promise<void> {
  const contract = (await (await fetch("/openapi.json")).json()) as Contract;
  adapt(contract);
  element("version").textContent = contract.info.version;
  const examples = new Examples(contract);
  const key = (): string | undefined => page.authSelectors.authorized().getIn(["key", "value"]);
  const page = SwaggerUI({
    spec: contract,
    domNode: element("operations"),
    deepLinking: true,
    defaultModelsExpandDepth: -1,
    displayRequestDuration: true,
    docExpansion: "list",
    requestInterceptor: async (request: Request) => {
      if (!request.loadSpec) await examples.prepare(request, key()).catch((error: Error) => say(error.message));
      return unquote(request);
    },
    tryItOutEnabled: true,
    syntaxHighlight: { theme: "monokai" },
    validatorUrl: null,
  });
  keepMended(element("operations"));
  foldConventions();
  const button = element<HTMLButtonElement>("prepare");
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      const made = await examples.create(key());
      page.specActions.updateSpec(JSON.stringify(contract));
      say(`Created: ${made.join(", ")}.`);
    } catch (error) {
      say((error as Error).message);
    }
    button.disabled = false;
  });
}

followSystem();
show().catch((error: Error) => say(`The contract could not be shown: ${error.message}`));
