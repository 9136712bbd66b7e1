// Types of the parts of Swagger UI that this page uses. The package has no types.
declare module "swagger-ui-dist/swagger-ui-es-bundle.js" {
  interface SwaggerUI {
    authSelectors: { authorized(): { getIn(path: string[]): string | undefined } };
    specActions: { updateSpec(text: string): void };
  }
  export default function SwaggerUI(options: Record<string, unknown>): SwaggerUI;
}

declare module "*.css";
