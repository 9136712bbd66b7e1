// What the page shows, as the fragment of its URL: a link shows the same.

export class State {
  private timer = 0;
  /** Whether something is still to be written. */
  isPending = false;

  get parameters(): URLSearchParams {
    return new URLSearchParams(location.hash.slice(1));
  }

  /** Writes soon; what is written meanwhile is written together. `read` says what. */
  write(read: () => Record<string, string>): void {
    clearTimeout(this.timer);
    this.isPending = true;
    this.timer = setTimeout(() => {
      this.isPending = false;
      const entries = Object.entries(read()).map(([name, value]) => `${name}=${encoded(value)}`);
      history.replaceState(null, "", `#${entries.join("&")}`);
    }, 250);
  }
}

/** Only what would end a parameter is escaped, so that people can read the link. */
const encoded = (value: string): string =>
  value.replace(/[%&#+ "<>]/g, (c) => `%${c.charCodeAt(0).toString(16).padStart(2, "0")}`);
