// A request as the command line that sends the same.

import { pathOf, type Request } from "./api.ts";

const quote = (text: string): string => (/^[\w./:=@%+,-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

function payload(request: Request): string[] {
  if (request.json !== undefined) return ["--json", quote(JSON.stringify(request.json))];
  return request.file ? ["-T", quote(request.file.name)] : [];
}

function method(request: Request): string[] {
  const usual = request.json !== undefined ? "POST" : request.file ? "PUT" : "GET";
  return request.method === usual ? [] : ["-X", request.method];
}

/** The key stands as a variable of the shell: what is copied is often pasted where others read it. */
export function curlOf(request: Request, origin: string, hasKey: boolean): string {
  const accept = request.accept ? ["-H", quote(`Accept: ${request.accept}`)] : [];
  const output = request.accept === "application/octet-stream" ? ["-o", "answer.bin"] : [];
  const key = hasKey ? ["-H", '"Authorization: Bearer $KEY"'] : [];
  const words = ["curl", ...method(request), ...accept, ...output, ...key, ...payload(request)];
  return [...words, quote(origin + pathOf(request))].join(" ");
}
