// Stores the content of the page in the fragment of its address. Each finished edit is a history
// entry, so the browser's Back and Forward are undo and redo.

const DELAY = 250; /* milliseconds; edits within this time become one entry */

/** Escapes only characters that would end a parameter, so that people can read the link. */
const encoded = (value: string): string =>
  value.replace(/[%&#+ "<>]/g, (c) => `%${c.charCodeAt(0).toString(16).padStart(2, "0")}`);

/** Returns the number of history entries that the page has made before the current one. */
const depth = (): number => (history.state as { depth?: number } | null)?.depth ?? 0;

export class State {
  private timer = 0;
  /** Like `depth()`, but counts steps back that the browser has not taken yet. */
  private depth = depth();
  private isEdit = false;
  /** Whether a write is pending until its delay ends. */
  isPending = false;
  /** The fragment that the page shows. */
  private current = location.hash;

  /**
   * `read` returns the parameters of the content. `onMove` is called after Back, Forward, or another
   * change of the fragment from outside.
   */
  constructor(
    private readonly read: () => Record<string, string>,
    onMove: () => void,
  ) {
    addEventListener("popstate", () => (this.depth = depth()));
    addEventListener("hashchange", () => {
      if (location.hash === this.current) return;
      this.current = location.hash;
      clearTimeout(this.timer);
      this.isPending = false;
      onMove();
    });
  }

  get parameters(): URLSearchParams {
    return new URLSearchParams(location.hash.slice(1));
  }

  /**
   * Writes the content after the delay. An edit makes a new history entry; otherwise the current
   * entry changes.
   */
  write(isEdit: boolean): void {
    clearTimeout(this.timer);
    this.isEdit ||= isEdit;
    this.isPending = true;
    this.timer = setTimeout(() => this.flush(), DELAY);
  }

  /** Writes a pending change at once. */
  flush(): void {
    if (!this.isPending) return;
    clearTimeout(this.timer);
    this.isPending = false;
    const entries = Object.entries(this.read()).map(([name, value]) => `${name}=${encoded(value)}`);
    const fragment = entries.length > 0 ? `#${entries.join("&")}` : "";
    const isNew = this.isEdit && fragment !== this.current && this.current !== "";
    this.isEdit = false;
    this.current = fragment;
    const target = fragment || location.pathname + location.search;
    if (isNew) this.depth++;
    if (isNew) history.pushState({ depth: this.depth }, "", target);
    else history.replaceState({ depth: this.depth }, "", target);
  }

  /** Returns to the previous history entry, but never leaves the page. */
  undo(): void {
    this.flush();
    if (this.depth === 0) return;
    this.depth--;
    history.back();
  }

  redo(): void {
    this.flush();
    history.forward();
  }
}
