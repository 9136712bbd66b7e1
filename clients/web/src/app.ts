// The viewer as a whole: it brings surface, mode, points, URL and panel together.

import type { Service } from "../../js/types.d.ts";
import { Answer } from "./answer.ts";
import { Api, ApiError } from "./api.ts";
import { Bench, isAbort } from "./bench.ts";
import { rememberCage } from "./cages.ts";
import { Chooser } from "./chooser.ts";
import { button, byId } from "./dom.ts";
import { Handles } from "./handles.ts";
import { Latest } from "./latest.ts";
import { Legend } from "./legend.ts";
import { loadSurface, namesOf } from "./load.ts";
import { allModes } from "./modes/index.ts";
import type { Mode } from "./modes/mode.ts";
import type { Place } from "./place.ts";
import { Points } from "./points.ts";
import { Rate } from "./rate.ts";
import { SAMPLES, type Sample } from "./samples.ts";
import { type Pixel, Scene } from "./scene.ts";
import { State } from "./state.ts";
import type { Kind, Surface } from "./surface.ts";
import { Units } from "./units.ts";
import { type Description, upload } from "./upload.ts";

const STARTING_FACES = 300000; /* a larger mesh is not opened unasked */
const PATIENCE = 700; /* milliseconds until the user is told that an answer takes long */
const KINDS: Kind[] = ["meshes", "subdivisions", "nurbs"];

/**
 * Where the first points of a surface lie: on a ring about the middle of the picture, and nearer to it where the
 * surface is not seen there.
 */
const RING = 6;
const RADII = [0.3, 0.22, 0.14, 0.07, 0];

export class App {
  readonly api = new Api();
  readonly scene = new Scene(byId<HTMLCanvasElement>("canvas"));
  readonly points = new Points();
  readonly units = new Units();
  readonly answer = new Answer(() => this.api.key !== "");
  readonly bench = new Bench(this.api, this.scene, this.points, this.answer, new Legend(), this.units, {
    ramp: "dusk",
  });
  readonly modes: Mode[] = allModes(this.bench);
  readonly rate = new Rate();
  mode: Mode = this.modes[0]!;
  /** Called when something has changed that parts of the panel show. */
  readonly watchers: (() => void)[] = [];
  /** Called when another surface is shown. */
  onSurface: () => void = () => {};
  private readonly handles = new Handles(byId("handles"), this.scene, this.points);
  private readonly state = new State();
  private readonly asker = new Latest<boolean>((live) => this.ask(live));
  private readonly chooser: Chooser;
  private opening: AbortController | undefined;
  /** The surface of each kind that was open last. */
  private readonly latest = new Map<Kind, string>();
  /** The surface that the points lie on. */
  private placesOf: Surface | undefined;
  /** How many surfaces are on their way. */
  private loads = 0;

  constructor() {
    this.chooser = new Chooser({
      open: (kind, name) => void this.open(kind, name),
      sample: (sample) => void this.openSample(sample),
      upload: (file, kind, query) => void this.upload(kind, { name: file.name, body: file }, query),
      remove: () => void this.remove(),
    });
    this.bench.onMeshes = () => void this.list();
    this.points.onChange = (live) => this.changed(live);
    this.points.onLook = () => this.showHandles();
    this.scene.onFrame = () => this.handles.place();
    this.scene.onCamera = () => this.writeState();
    for (const mode of this.modes) mode.settings.onChange = (live) => this.changed(live);
    addEventListener("hashchange", () => void this.restore());
  }

  /** What the URL says, or what there is. */
  async start(): Promise<void> {
    await this.list();
    await this.readFormats();
    await this.restore();
  }

  private async readFormats(): Promise<void> {
    const service = await this.api.get<Service>("/v1").catch(() => null);
    if (service) this.chooser.showFormats(service.capabilities.formats);
  }

  private async list(): Promise<void> {
    try {
      const [meshes, subdivisions, nurbs] = await Promise.all(KINDS.map((kind) => namesOf(this.api, kind)));
      this.bench.taken = new Set(meshes);
      this.chooser.show({ meshes: meshes!, subdivisions: subdivisions!, nurbs: nurbs! }, this.bench.surface);
    } catch (error) {
      this.fail(error);
    }
  }

  /** Reads the lists of surfaces again, after a key was given for instance. */
  async reload(): Promise<void> {
    this.answer.clear();
    await this.start();
  }

  private fail(error: unknown, ...remedy: Node[]): void {
    if (isAbort(error)) return;
    this.answer.fail(error, ...remedy);
    if (error instanceof ApiError && error.status === 401) byId<HTMLDetailsElement>("access").open = true;
  }

  private say(text: string): void {
    byId("busy").textContent = text;
  }

  // --- surfaces ------------------------------------------------------------------------------------------------------

  private async restore(): Promise<void> {
    const parameters = this.state.parameters;
    const kind = KINDS.find((name) => parameters.has(name));
    const wanted = this.modes.find((mode) => mode.id === parameters.get("mode"));
    if (kind) {
      this.mode = wanted?.kind === kind ? wanted : this.modes.find((mode) => mode.kind === kind)!;
      await this.open(kind, parameters.get(kind)!, parameters);
    } else {
      if (wanted) this.mode = wanted;
      await (wanted && wanted.kind !== "meshes" ? this.openKind(wanted.kind) : this.openSomething());
    }
  }

  /** The surface of a kind that was open last, the first one that there is, or a sample. */
  private async openKind(kind: Kind): Promise<void> {
    const names = this.chooser.known[kind];
    const known =
      names.find((name) => name === this.latest.get(kind)) ?? names.find((name) => !/-(limit|mesh)$/.test(name));
    if (known) await this.open(kind, known);
    else await this.openSample(SAMPLES.find((sample) => sample.kind === kind)!);
  }

  /** The first mesh of the daemon, unless it is very large; else the user is shown where to begin. */
  private async openSomething(): Promise<void> {
    const first = this.chooser.known.meshes[0];
    const mesh =
      first && (await this.api.get<{ faces: number }>(`/v1/meshes/${encodeURIComponent(first)}`).catch(() => null));
    if (mesh && mesh.faces <= STARTING_FACES) return this.open("meshes", first);
    byId("start").hidden = this.bench.surface !== undefined;
    this.tell();
  }

  async open(kind: Kind, name: string, parameters?: URLSearchParams): Promise<void> {
    this.bench.abort();
    this.say(`Loading ${name}.`);
    this.loads++;
    try {
      const surface = await loadSurface(this.api, kind, name, (request) => this.bench.prelude.push(request));
      this.showSurface(surface, parameters);
    } catch (error) {
      this.fail(error);
      byId("start").hidden = this.bench.surface !== undefined;
    }
    this.loads--;
    this.say("");
  }

  private showSurface(surface: Surface, parameters?: URLSearchParams): void {
    byId("start").hidden = true;
    this.answer.clear();
    this.bench.surface = surface;
    this.latest.set(surface.kind, surface.name);
    this.scene.show(surface);
    this.onSurface();
    this.scene.up = parameters?.get("up") ?? SAMPLES.find((sample) => sample.name === surface.name)?.up ?? "y";
    this.scene.fit();
    if (parameters?.has("camera")) this.scene.view = parameters.get("camera")!;
    if (this.mode.kind !== surface.kind) this.mode = this.modes.find((mode) => mode.kind === surface.kind)!;
    this.chooser.show(this.chooser.known, surface);
    this.chooser.expect(surface.kind);
    this.enterMode(parameters);
  }

  async openSample(sample: Sample): Promise<void> {
    if (this.chooser.known[sample.kind].includes(sample.name)) return this.open(sample.kind, sample.name);
    const { name, text } = sample.file();
    await this.upload(sample.kind, { name, body: new Blob([text]) }, {});
  }

  private async upload(kind: Kind, file: { name: string; body: Blob }, query: Record<string, string>): Promise<void> {
    this.opening?.abort();
    const opening = (this.opening = new AbortController());
    const onUpload = (what: string, part: number): void =>
      this.answer.showProgress(`${what} ${file.name}`, part, () => opening.abort());
    let made: Description | undefined;
    this.loads++;
    try {
      if (kind === "subdivisions") await rememberCage(await file.body.text());
      made = await upload(this.api, kind, file, query, onUpload, opening.signal);
      await this.list();
    } catch (error) {
      const mend = (): void => void this.upload(kind, file, { ...query, repair: "split" });
      const isMendable = error instanceof ApiError && !!error.problem.detail?.includes("?repair=split");
      this.fail(error, ...(isMendable ? [button("Mend and upload", mend)] : []));
    }
    this.answer.hideProgress();
    this.opening = undefined;
    if (made) {
      this.bench.prelude = [{ method: "PUT", path: `/v1/${kind}/${encodeURIComponent(made.name)}`, query, file }];
      await this.open(kind, made.name);
    }
    this.loads--;
  }

  private async remove(): Promise<void> {
    const surface = this.bench.surface;
    if (!surface || !confirm(`Delete ${surface.name} from the daemon, for everybody?`)) return;
    try {
      await this.api.send({ method: "DELETE", path: surface.path });
      this.bench.surface = undefined;
      this.scene.show(undefined);
      this.points.reset([]);
      this.handles.update();
      history.replaceState(null, "", " ");
      await this.list();
      byId("start").hidden = false;
    } catch (error) {
      this.fail(error);
    }
  }

  // --- modes ---------------------------------------------------------------------------------------------------------

  /** Changes the mode; where it needs another kind of surface, one of that kind is opened. */
  async choose(mode: Mode): Promise<void> {
    if (mode === this.mode && this.bench.surface?.kind === mode.kind) return;
    this.leaveMode();
    this.mode = mode;
    if (this.bench.surface?.kind === mode.kind) this.enterMode();
    else await this.openKind(mode.kind);
  }

  private leaveMode(): void {
    this.bench.abort();
    this.mode.clear();
    this.answer.clear();
  }

  private enterMode(parameters?: URLSearchParams): void {
    const { mode, points, bench } = this;
    const before = this.placesOf === bench.surface ? points.all.map(({ place }) => place) : [];
    this.placesOf = bench.surface;
    points.reset(mode.groups);
    if (parameters) mode.settings.restore(parameters);
    mode.enter();
    byId("hint").textContent = mode.hint;
    byId("mode").replaceChildren(...mode.settings.elements(), ...mode.extras());
    for (const group of mode.groups) {
      const text = parameters?.get(group.id);
      if (text) points.restore(group.id, text, bench.surface!);
    }
    if (points.all.length === 0) this.setFirstPoints(before);
    this.changed(false);
  }

  /**
   * As many points as the mode begins with: those of the mode before, then places where the surface is seen about the
   * middle of the picture.
   */
  private setFirstPoints(before: Place[]): void {
    let spot = before.length;
    for (const group of this.mode.groups) {
      const places = Array.from({ length: group.first ?? group.least }, () => before.shift() ?? this.spot(spot++));
      this.points.set(
        group.id,
        places.filter((place) => place !== null),
      );
    }
  }

  private spot(i: number): Place | null {
    const { x, y } = this.scene.size;
    const angle = 2.4 + (2 * Math.PI * (i % RING)) / RING;
    for (const part of RADII) {
      const radius = part * Math.min(x, y) * (i < RING ? 1 : 0.5);
      const place = this.scene.pick({ x: x / 2 + radius * Math.cos(angle), y: y / 2 + radius * Math.sin(angle) });
      if (place) return place;
    }
    return null;
  }

  /** Points or settings have changed: ask again, newest first. */
  changed(live: boolean): void {
    this.showHandles();
    this.tell();
    this.writeState();
    if (live && !this.mode.followsDrag) return;
    this.bench.makeWay(live);
    this.asker.put(live);
  }

  private showWaiting(): void {
    if (!this.answer.showsProgress) this.answer.showProgress("Waiting for the answer", null, () => this.bench.abort());
  }

  private showHandles(): void {
    byId("handles").hidden = !this.mode.showsPoints;
    this.handles.update();
  }

  private async ask(live: boolean): Promise<void> {
    const { bench, mode, points } = this;
    if (!bench.surface || bench.surface.kind !== mode.kind) return;
    if (!points.complete) return mode.clear();
    bench.begin();
    const waiting = setTimeout(() => this.showWaiting(), PATIENCE);
    try {
      await mode.ask(live);
      if (live) this.rate.count();
    } catch (error) {
      if (!isAbort(error)) mode.clear();
      this.fail(error);
    }
    clearTimeout(waiting);
    bench.end();
    this.showHandles();
    this.tell();
  }

  // --- the rest of the page ------------------------------------------------------------------------------------------

  private tell(): void {
    for (const watch of this.watchers) watch();
  }

  get busy(): boolean {
    return this.asker.busy || this.loads > 0 || this.state.isPending;
  }

  /** Drops the question and the upload under way. */
  cancel(): void {
    this.bench.abort();
    this.opening?.abort();
  }

  showFacts(): void {
    this.chooser.showFacts(this.bench.surface, this.units);
  }

  /** Sets a point where a pixel shows the surface. */
  addAt(pixel: Pixel): void {
    const place = this.scene.pick(pixel);
    if (place) this.points.add(place);
  }

  writeState(): void {
    this.state.write(() => this.read());
  }

  read(): Record<string, string> {
    const { surface } = this.bench;
    if (!surface) return {};
    const groups = this.mode.groups
      .map((group) => [group.id, this.points.text(group.id)] as const)
      .filter(([, text]) => text);
    return {
      [surface.kind]: surface.name,
      mode: this.mode.id,
      ...Object.fromEntries(groups),
      ...this.mode.settings.read(),
      ...(this.scene.up === "z" && { up: "z" }),
      camera: this.scene.view,
    };
  }
}
