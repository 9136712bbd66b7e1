/* <geodesic-viewer>: the daemon's viewer as an element of any page. The daemon's --frame-ancestors
 * must list the page's origin. See viewer.d.ts. */

const POINTS = ["from", "to", "via", "source", "points", "start", "towards", "a", "b"];
const VIEW = ["mode", "unit", "ramp", "edges", "up", "camera"];

/* Escapes only characters that would end a parameter of the fragment. */
const escaped = (text) =>
  text.replace(/[%&#+ "<>]/g, (c) => `%${c.charCodeAt(0).toString(16).padStart(2, "0")}`);

const HTMLElementOrNone = globalThis.HTMLElement ?? class {}; // Node.js has no HTMLElement

export class GeodesicViewer extends HTMLElementOrNone {
  static observedAttributes = ["server", "mesh", "subdivision", "nurbs", ...POINTS, ...VIEW];

  #frame;
  #hear = (event) => this.#receive(event);

  connectedCallback() {
    this.#frame = document.createElement("iframe");
    this.#frame.title = this.getAttribute("title") ?? "A surface with geodesics";
    this.#frame.style.cssText = "width: 100%; height: 100%; border: 0; display: block";
    this.#frame.src = `${this.server}/?embed=1#${this.fragment}`;
    const root = this.shadowRoot ?? this.attachShadow({ mode: "open" });
    const style = document.createElement("style");
    style.textContent = ":host { display: block; height: 24rem; }";
    root.replaceChildren(style, this.#frame);
    addEventListener("message", this.#hear);
  }

  disconnectedCallback() {
    removeEventListener("message", this.#hear);
    this.#frame = undefined;
  }

  /* The frame keeps its surface and repeats its query. If several changes arrive during a query,
   * the frame applies only the newest change. */
  attributeChangedCallback(name) {
    if (!this.#frame) return;
    if (name === "server") this.#frame.src = `${this.server}/?embed=1#${this.fragment}`;
    else
      this.#frame.contentWindow.postMessage(
        { geodesicd: "show", fragment: this.fragment },
        this.server,
      );
  }

  get server() {
    return new URL(this.getAttribute("server") ?? "http://127.0.0.1:8080", location.href).origin;
  }

  /* The fragment of the address that "Copy link" of the viewer copies. */
  get fragment() {
    const kind = ["subdivision", "nurbs"].find((name) => this.hasAttribute(name));
    const surface = kind
      ? [kind === "nurbs" ? "nurbs" : "subdivisions", this.getAttribute(kind)]
      : ["meshes", this.getAttribute("mesh") ?? ""];
    const others = [...POINTS, ...VIEW]
      .filter((name) => this.hasAttribute(name))
      .map((name) => [name, this.getAttribute(name)]);
    return [surface, ...others].map(([name, value]) => `${name}=${escaped(value)}`).join("&");
  }

  #receive({ source, origin, data }) {
    if (source !== this.#frame?.contentWindow || origin !== this.server) return;
    const { geodesicd: type, length, state, message } = data ?? {};
    if (type === "answer") this.#fire(type, { length, state });
    if (type === "error") this.#fire(type, { message });
  }

  #fire(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}

if (globalThis.customElements && !customElements.get("geodesic-viewer"))
  customElements.define("geodesic-viewer", GeodesicViewer);
