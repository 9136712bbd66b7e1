// Files from the daemon to the user's disk. Fetched, not linked, because a link could not send the access key.

import type { Request } from "./api.ts";
import type { Bench } from "./bench.ts";
import { make } from "./dom.ts";

export async function download(bench: Bench, request: Request, name: string): Promise<void> {
  await bench.question(async () => {
    const bytes = await bench.api.bytes(request);
    bench.made.push(request);
    const url = URL.createObjectURL(new Blob([bytes]));
    make("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  });
}
