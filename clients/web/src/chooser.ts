// The choice of a surface: a surface of the daemon, a sample, or a file.

import type { Mesh, Nurbs, Subdivision } from "../../js/types.d.ts";
import { button, byId, freshId, isEmbedded, make } from "./dom.ts";
import { SAMPLES, type Sample } from "./samples.ts";
import type { Kind, Surface } from "./surface.ts";
import { type Units, whole } from "./units.ts";
import type { UserFile } from "./uploads.ts";

const START_NAMES = 12; /* largest number of the daemon's surfaces on the start card */

const KINDS: [Kind, string][] = [
  ["meshes", "Meshes"],
  ["subdivisions", "Subdivision surfaces"],
  ["nurbs", "NURBS surfaces"],
];

/** The ways to read a file: value, label, kind and parameters of the upload. */
const UPLOADS: [string, string, Kind, Record<string, string>][] = [
  ["mesh", "a mesh", "meshes", {}],
  ["mended", "a mesh, repaired where it is not manifold", "meshes", { repair: "split", weld: "0" }],
  ["cage", "a Catmull-Clark control cage", "subdivisions", { scheme: "catmull_clark" }],
  ["loop", "a Loop control cage", "subdivisions", { scheme: "loop" }],
  ["nurbs", "a NURBS surface (JSON)", "nurbs", {}],
];

export interface ChooserCalls {
  open: (kind: Kind, name: string) => void;
  sample: (sample: Sample) => void;
  upload: (files: UserFile[]) => void;
  remove: () => void;
}

export class Chooser {
  private readonly select: HTMLSelectElement;
  private readonly how: HTMLSelectElement;
  private readonly file = make("input", {
    type: "file",
    id: "file",
    multiple: true,
    "aria-label": "File to upload",
  });
  private readonly facts = make("p", { class: "faint", id: "surface-facts" });
  private readonly remove: HTMLButtonElement;
  private names: Record<Kind, string[]> = { meshes: [], subdivisions: [], nurbs: [] };
  private shown = "";

  constructor(private readonly calls: ChooserCalls) {
    const [selectId, howId] = [freshId(), freshId()];
    this.select = make("select", { id: selectId, change: () => this.choose() });
    this.how = make(
      "select",
      { id: howId },
      ...UPLOADS.map(([value, label]) => make("option", { value }, label)),
    );
    this.remove = button("Delete", calls.remove, {
      class: "quiet",
      title: "Delete this surface from the daemon",
    });
    this.file.addEventListener("change", () => {
      this.take([...(this.file.files ?? [])]);
      this.file.value = "";
    });
    this.build(selectId, howId);
    if (!isEmbedded) this.listenForDrops();
  }

  private build(selectId: string, howId: string): void {
    const pick = button("Upload", () => this.file.click(), {
      title: "Upload files; or drop them on the window",
    });
    const samples = (): HTMLElement[] =>
      SAMPLES.map((sample) => button(sample.title, () => this.calls.sample(sample)));
    byId("chooser").append(
      make("label", { for: selectId, class: "unseen" }, "On the daemon"),
      make("div", { class: "row tight" }, this.select, pick, this.file),
      make("div", { class: "row facts" }, this.facts, this.remove),
      make(
        "details",
        {},
        make("summary", {}, "Samples, and how to read files"),
        make("div", { class: "row" }, ...samples()),
        make("div", { class: "field" }, make("label", { for: howId }, "A file is"), this.how),
      ),
    );
    byId("start-samples").append(...samples());
  }

  private choose(): void {
    const [kind, name] = this.select.value.split("/") as [Kind, string];
    if (name) this.calls.open(kind, name);
  }

  /** Uploads files, read as the user has chosen. Only JSON files can be NURBS surfaces. */
  private take(files: File[]): void {
    const chosen = UPLOADS.find(([value]) => value === this.how.value)!;
    const uploads = files.map((file) => {
      const isMesh = chosen[2] === "nurbs" && !/\.json(\.gz)?$/i.test(file.name);
      const [, , kind, query] = isMesh ? UPLOADS[0]! : chosen;
      return { kind, name: file.name, body: file, query };
    });
    this.calls.upload(uploads);
  }

  private listenForDrops(): void {
    const sign = byId("drop");
    addEventListener("dragover", (event) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      sign.hidden = false;
    });
    addEventListener("dragleave", (event) => {
      if (!event.relatedTarget) sign.hidden = true;
    });
    addEventListener("drop", (event) => {
      event.preventDefault();
      sign.hidden = true;
      this.take([...(event.dataTransfer?.files ?? [])]);
    });
  }

  /** Shows the formats that the daemon reads. */
  showFormats(formats: string[]): void {
    this.file.accept = [...formats, "gz"].map((ending) => `.${ending}`).join(",");
    byId("start-formats").textContent = formats.map((format) => format.toUpperCase()).join(", ");
  }

  /** Shows the surfaces of the daemon; `open` is the open surface. */
  show(names: Record<Kind, string[]>, open: Surface | undefined): void {
    if (JSON.stringify(names) !== this.shown) this.list(names);
    this.select.value = open ? `${open.kind}/${open.name}` : "";
    this.remove.hidden = !open;
  }

  /** Replaces the lists of names. This closes the list if the user has opened it. */
  private list(names: Record<Kind, string[]>): void {
    this.shown = JSON.stringify(names);
    this.names = names;
    const groups = KINDS.filter(([kind]) => names[kind].length > 0).map(([kind, label]) =>
      make(
        "optgroup",
        { label },
        ...names[kind].map((name) => make("option", { value: `${kind}/${name}` }, name)),
      ),
    );
    const hint = groups.length > 0 ? "Choose a surface" : "Nothing yet";
    this.select.replaceChildren(make("option", { value: "" }, hint), ...groups);
    this.showStart();
  }

  /** Shows the daemon's first surfaces on the start card. */
  private showStart(): void {
    const known = KINDS.flatMap(([kind]) => this.names[kind].map((name) => ({ kind, name })));
    const buttons = known
      .slice(0, START_NAMES)
      .map(({ kind, name }) => button(name, () => this.calls.open(kind, name)));
    byId("start-known").hidden = known.length === 0;
    byId("start-names").replaceChildren(...buttons);
  }

  get known(): Record<Kind, string[]> {
    return this.names;
  }

  /** Reads files as this kind of surface until the user chooses another kind. */
  expect(kind: Kind): void {
    if (UPLOADS.find(([value]) => value === this.how.value)![2] !== kind)
      this.how.value = UPLOADS.find((row) => row[2] === kind)![0];
  }

  showFacts(surface: Surface | undefined, units: Units): void {
    this.facts.textContent = surface ? factsOf(surface, units) : "";
  }
}

const plural = (count: number, one: string, many: string): string =>
  `${whole(count)} ${count === 1 ? one : many}`;

function meshFacts(mesh: Mesh, units: Units): string {
  const parts = [`${whole(mesh.faces)} faces`, `area ${units.area(mesh.area)}`];
  if (mesh.components !== 1) parts.push(plural(mesh.components, "component", "components"));
  const boundaries = mesh.boundary_count ?? mesh.boundaries.length;
  if (boundaries) parts.push(plural(boundaries, "boundary", "boundaries"));
  if (mesh.genus) parts.push(`genus ${mesh.genus}`);
  return parts.join(", ");
}

function factsOf(surface: Surface, units: Units): string {
  if (surface.kind === "meshes") {
    const { deviation } = surface;
    const facts = meshFacts(surface.description as Mesh, units);
    if (deviation === undefined) return facts;
    return `${facts}. Drawn with ${whole(surface.drawnFaces)} faces, at most ${units.length(deviation, 2)} off`;
  }
  const shown = `Drawn with ${whole(surface.drawnFaces)} faces.`;
  if (surface.kind === "nurbs") {
    const { shape, degree, control_points: points } = surface.description as Nurbs;
    return `${points ? `${points.join(" × ")} control points of degree ${degree!.join(" × ")}. ` : `A ${shape}. `}${shown}`;
  }
  const { scheme, faces } = surface.description as Subdivision;
  return `${scheme === "loop" ? "Loop" : "Catmull-Clark"}, ${plural(faces, "face", "faces")} of the control mesh. ${shown}`;
}
