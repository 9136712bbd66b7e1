// Connects the parts of the viewer: surface, mode, points, address and panel.

import type { Service } from "../../js/types.d.ts";
import { Answer } from "./answer.ts";
import { Api, ApiError, Cancelled, NoAnswer } from "./api.ts";
import { Bench, isAbort } from "./bench.ts";
import { rememberCage } from "./cages.ts";
import { Chooser } from "./chooser.ts";
import { Display } from "./display.ts";
import { button, byId } from "./dom.ts";
import { Handles } from "./handles.ts";
import { Latest, Rate } from "./latest.ts";
import { Legend } from "./legend.ts";
import { loadSurface, namesOf } from "./load.ts";
import { allModes } from "./modes/index.ts";
import type { Mode } from "./modes/mode.ts";
import { type Place, snapped } from "./place.ts";
import { messageOf, Notice, Waits } from "./notice.ts";
import { Points, startPlace } from "./points.ts";
import { SAMPLES, type Sample } from "./samples.ts";
import { type Pixel, Scene } from "./scene.ts";
import { State } from "./state.ts";
import { type Kind, type Surface, surfacePath } from "./surface.ts";
import { Units } from "./units.ts";
import { type Made, textOf, Uploads, type UserFile } from "./uploads.ts";

const STARTING_FACES = 300000; /* the page opens a larger mesh only if the user requests this */
const PATIENCE = 700; /* milliseconds until the page shows that it waits for an answer */
const KINDS: Kind[] = ["meshes", "subdivisions", "nurbs"];
/* statuses after which the same request may succeed */
const RETRIED = [401, 404, 410, 429, 503, 504];

/**
 * Returns whether a ray missed the surface. Near the outline, a ray may hit the preview but not the
 * original. During a drag, the previous answer then stays.
 */
const isMiss = (error: unknown): boolean => error instanceof ApiError && error.status === 422;

/** Returns a promise that is rejected when the signal is aborted. */
const rejected = (signal: AbortSignal): Promise<never> =>
  new Promise((_, reject) => signal.addEventListener("abort", () => reject(signal.reason)));

/** The parameters of an address and the mode with which a surface is shown. */
interface View {
  parameters?: URLSearchParams;
  mode?: Mode;
}

interface Wanted {
  kind: Kind;
  name: string;
  view: View;
}

export class App {
  readonly api = new Api();
  readonly scene = new Scene(byId<HTMLCanvasElement>("canvas"));
  readonly points = new Points();
  readonly units = new Units();
  readonly answer = new Answer(() => this.api.key !== "");
  readonly bench = new Bench(
    this.api,
    this.scene,
    this.points,
    this.answer,
    new Legend(),
    this.units,
  );
  readonly modes: Mode[] = allModes(this.bench);
  readonly rate = new Rate();
  mode: Mode = this.modes[0]!;
  /** Called when content that the panel shows may have changed. */
  readonly watchers: (() => void)[] = [];
  /** Called after an error of a load or a query. */
  onTrouble: (message: string) => void = () => {};
  readonly display: Display;
  private readonly handles = new Handles(byId("handles"), this.scene, this.points);
  private readonly state = new State(
    () => this.read(),
    () => void this.restore(),
  );
  private readonly asker = new Latest<boolean>((live) => this.ask(live));
  private readonly chooser: Chooser;
  private readonly uploads: Uploads;
  /** For each kind, the name of the surface that was opened last. */
  private readonly latest = new Map<Kind, string>();
  /** The surface that the points lie on. */
  private placesOf: Surface | undefined;
  /** Number of surfaces and files that are being read. */
  private loads = 0;
  /** The load of the surface that was chosen last, and the kind of this surface. */
  private loading = new AbortController();
  private loadingKind: Kind = "meshes";
  /** Errors about surfaces. */
  private readonly troubles = new Notice();
  private readonly waits = new Waits(byId("busy"));

  constructor() {
    this.chooser = new Chooser({
      open: (kind, name) => void this.open(kind, name),
      sample: (sample) => void this.openSample(sample),
      upload: (files) => void this.upload(files),
      remove: () => void this.remove(),
    });
    this.uploads = new Uploads(
      this.api,
      (kind) => this.chooser.known[kind],
      (made) => this.openMade(made),
    );
    byId("loads").append(this.troubles.node);
    addEventListener("focus", () => void this.list(() => {})); /* for changes by other clients */
    this.display = new Display(this);
    this.bench.onMeshes = () => this.list();
    this.bench.remedies = (error, retry) =>
      this.remedies(error, retry ?? (() => this.changed(false, false)));
    this.points.onChange = (live) => this.changed(live);
    this.points.onLook = () => this.showHandles();
    this.scene.onFrame = () => this.handles.place();
    this.scene.isWaiting = () => this.asker.busy || this.loads > 0 || this.uploads.busy;
    this.scene.onCamera = () => this.writeView(false);
    const lost = "The browser has lost the picture. If it does not return, reload the page.";
    this.scene.onLoss = (isLost) => this.waits.say("picture", isLost ? lost : "");
    this.api.onPause = (seconds) => this.sayPause(seconds);
    for (const mode of this.modes) mode.settings.onChange = (live) => this.changed(live);
  }

  /** Shows the content that the address names, or a surface of the daemon. */
  async start(): Promise<void> {
    const listed = Promise.all([this.list(), this.readFormats()]);
    const isNamed = KINDS.some((kind) => this.state.parameters.has(kind));
    if (!isNamed) await listed;
    await this.restore();
    await listed;
  }

  private async readFormats(): Promise<void> {
    const service = await this.api.get<Service>("/v1").catch(() => null);
    if (service) this.chooser.showFormats(service.capabilities.formats);
  }

  /** Reads the names of the daemon's surfaces. */
  private async list(onError = (error: unknown): void => this.failList(error)): Promise<void> {
    try {
      const [meshes, subdivisions, nurbs] = await Promise.all(
        KINDS.map((kind) => namesOf(this.api, kind)),
      );
      this.bench.taken = new Set(meshes);
      this.chooser.show(
        { meshes: meshes!, subdivisions: subdivisions!, nurbs: nurbs! },
        this.bench.surface,
      );
    } catch (error) {
      onError(error);
    }
  }

  private failList(error: unknown): void {
    this.fail(error, () => this.reload());
  }

  /** Loads everything again, for example with a new access key. */
  async reload(): Promise<void> {
    this.troubles.warn("");
    await this.start();
  }

  /** Returns buttons for the next step after an error; `retry` repeats the work. */
  private remedies(error: unknown, retry: () => unknown): Node[] {
    const { surface } = this.bench;
    if (error instanceof ApiError && error.status === 401)
      byId<HTMLDetailsElement>("access").open = true;
    if (error instanceof ApiError && error.status === 412 && surface)
      return [button("Load it again", () => void this.loadAgain(surface), { class: "main" })];
    const isRetried =
      error instanceof NoAnswer ||
      error instanceof Cancelled ||
      (error instanceof ApiError && RETRIED.includes(error.status));
    return isRetried ? [button("Try again", () => void retry(), { class: "main" })] : [];
  }

  /** Shows an error about surfaces. The answer of the open surface stays valid. */
  private fail(error: unknown, retry: () => unknown): void {
    if (isAbort(error)) return;
    this.troubles.warn(messageOf(error), ...this.remedies(error, retry));
    this.onTrouble(messageOf(error));
  }

  private sayLoad(text: string): void {
    this.waits.say("load", text, () => this.cancelLoad());
  }

  private sayPause(seconds: number | null): void {
    const text = `The daemon accepts no requests at present. Next try in ${seconds} s.`;
    this.waits.say("pause", seconds === null ? "" : text, () => this.api.endPauses());
  }

  // --- surfaces ----------------------------------------------------------------------------------

  private async restore(): Promise<void> {
    const parameters = this.state.parameters;
    const kind = KINDS.find((name) => parameters.has(name));
    const wanted = this.modes.find((mode) => mode.id === parameters.get("mode"));
    if (kind) {
      const mode = wanted?.kind === kind ? wanted : this.modes.find((one) => one.kind === kind);
      await this.show(kind, parameters.get(kind)!, { parameters, mode });
    } else if (wanted && wanted.kind !== "meshes") await this.openKind(wanted);
    else await this.openFirst(wanted);
  }

  /** Shows a surface with the parameters of an address. Loads it unless it is open. */
  private async show(kind: Kind, name: string, view: View): Promise<void> {
    const { surface } = this.bench;
    if (surface?.kind !== kind || surface.name !== name) return this.open(kind, name, view);
    this.stopLoading();
    this.leaveMode();
    this.mode = view.mode!;
    this.applyView(view.parameters);
    this.enterMode(view.parameters);
  }

  /** Ends a load, because the user has chosen the open surface instead. */
  private stopLoading(): void {
    this.loading.abort();
    this.sayLoad("");
  }

  /** Ends the running load for the user, who is told so. */
  private cancelLoad(): void {
    this.loading.abort(new Cancelled("You have cancelled the load."));
    this.sayLoad("");
  }

  /**
   * Opens a surface of the mode's kind: the surface that was opened last, or else the daemon's
   * first surface, or else a sample.
   */
  private async openKind(mode: Mode): Promise<void> {
    const { kind } = mode;
    const names = this.chooser.known[kind];
    const known = names.find((name) => name === this.latest.get(kind)) ?? names[0];
    if (known) await this.open(kind, known, { mode });
    else await this.openSample(SAMPLES.find((sample) => sample.kind === kind)!);
  }

  /** Opens the daemon's first mesh. If there is none or it is very large, shows the start card. */
  private async openFirst(mode?: Mode): Promise<void> {
    const first = this.chooser.known.meshes[0];
    const mesh =
      first &&
      (await this.api.get<{ faces: number }>(surfacePath("meshes", first)).catch(() => null));
    if (mesh && mesh.faces <= STARTING_FACES) return this.open("meshes", first, { mode });
    byId("start").hidden = this.bench.surface !== undefined;
    if (!this.bench.surface) this.scene.warmUp();
    this.tell();
  }

  /** Loads a surface and shows it. Aborts an earlier load that still runs. */
  async open(kind: Kind, name: string, view: View = {}): Promise<void> {
    this.loading.abort();
    const { signal } = (this.loading = new AbortController());
    this.loadingKind = kind;
    this.troubles.warn("");
    this.sayLoad(`Loading ${name}`);
    this.loads++;
    const onPart = (part: number): void =>
      signal.aborted ? undefined : this.sayLoad(`Loading ${name}, ${Math.floor(100 * part)} %`);
    try {
      const load = loadSurface(this.api, kind, name, { signal, onPart });
      const surface = await Promise.race([load, rejected(signal)]);
      if (!signal.aborted) this.showSurface(surface, view);
    } catch (error) {
      this.failLoad(signal.aborted ? signal.reason : error, { kind, name, view });
    }
    this.loads--;
    if (!signal.aborted) this.sayLoad("");
  }

  /**
   * Reports that a surface could not be loaded. The open surface stays open, unless the page's
   * address names the failed surface.
   */
  private failLoad(error: unknown, { kind, name, view }: Wanted): void {
    if (isAbort(error)) return;
    if (view.parameters) this.close();
    byId("start").hidden = this.bench.surface !== undefined;
    this.chooser.show(this.chooser.known, this.bench.surface);
    this.fail(error, () => this.open(kind, name, view));
    this.tell();
    if (error instanceof ApiError && error.status === 404) void this.list(() => {});
  }

  /**
   * Loads the current version of a surface from the daemon and shows it. Keeps points and settings.
   */
  private loadAgain({ kind, name }: Surface): Promise<void> {
    return this.open(kind, name, { parameters: new URLSearchParams(this.read()), mode: this.mode });
  }

  private showSurface(surface: Surface, { parameters, mode }: View): void {
    byId("start").hidden = true;
    this.leaveMode();
    this.bench.surface = surface;
    this.latest.set(surface.kind, surface.name);
    this.scene.show(surface);
    this.applyView(parameters);
    const isKept = this.mode.kind === surface.kind;
    const usual = isKept ? this.mode : this.modes.find(({ kind }) => kind === surface.kind)!;
    this.mode = mode ?? usual;
    this.chooser.show(this.chooser.known, surface);
    this.chooser.expect(surface.kind);
    this.enterMode(parameters);
  }

  /** Shows no surface. */
  private close(): void {
    this.leaveMode();
    this.bench.surface = undefined;
    this.scene.show(undefined);
    this.points.reset([]);
    this.handles.update();
    byId("start").hidden = false;
    this.tell();
  }

  private applyView(parameters?: URLSearchParams): void {
    const surface = this.bench.surface!;
    this.display.restore(parameters);
    const sample = SAMPLES.find(({ name }) => name === surface.name);
    const usual = surface.kind === "nurbs" ? "z" : "y"; /* in CAD z is upwards, elsewhere y */
    this.scene.up = parameters?.get("up") ?? sample?.up ?? usual;
    this.scene.fit();
    this.scene.view = parameters?.get("camera") ?? "";
  }

  async openSample(sample: Sample): Promise<void> {
    if (this.chooser.known[sample.kind].includes(sample.name))
      return this.open(sample.kind, sample.name);
    const { name, text } = sample.file();
    await this.upload([{ kind: sample.kind, name, body: new Blob([text]), query: {} }]);
  }

  private async upload(files: UserFile[]): Promise<void> {
    this.loads++;
    for (const file of files)
      if (file.kind === "subdivisions") await rememberCage(await textOf(file));
    const added = this.uploads.add(files);
    this.loads--;
    await added;
  }

  /** Opens the surface that was uploaded last. */
  private async openMade(made: Made[]): Promise<void> {
    const { kind, name, request } = made.at(-1)!;
    this.bench.prelude = [request];
    await Promise.all([this.list(), this.open(kind, name)]);
  }

  private async remove(): Promise<void> {
    const surface = this.bench.surface;
    if (!surface || !confirm(`Delete ${surface.name} from the daemon, for everybody?`)) return;
    try {
      await this.api.send({ method: "DELETE", path: surface.path });
    } catch (error) {
      const isGone = error instanceof ApiError && error.status === 404;
      if (!isGone) return this.fail(error, () => this.remove());
    }
    if (this.bench.surface === surface) this.close();
    this.state.write(false);
    await this.list();
  }

  // --- modes -------------------------------------------------------------------------------------

  /** Changes the mode. If it needs another kind of surface, opens a surface of that kind. */
  async choose(mode: Mode): Promise<void> {
    const isOpen = this.bench.surface?.kind === mode.kind;
    if (isOpen && this.loadingKind !== mode.kind) this.stopLoading();
    if (mode === this.mode && isOpen) return;
    if (!isOpen) {
      await this.openKind(mode);
      return this.tell(); /* if the load failed, the picker shows the former mode again */
    }
    this.leaveMode();
    this.mode = mode;
    this.enterMode();
  }

  private leaveMode(): void {
    this.bench.forget();
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
      if (text && text !== "none") points.restore(group.id, text, bench.surface!);
    }
    const hasPoints = ["points", ...mode.groups.map(({ id }) => id)].some((id) =>
      parameters?.has(id),
    );
    if (!hasPoints) this.setFirstPoints(before);
    this.changed(false, !parameters);
  }

  /**
   * Sets the points that the mode begins with: the points of the previous mode. If they are too
   * few, points at fixed positions of the picture are added (`startPlace`).
   */
  private setFirstPoints(before: Place[]): void {
    let next = before.length;
    for (const group of this.mode.groups) {
      const count = group.first ?? group.least;
      const places = Array.from(
        { length: count },
        () => before.shift() ?? startPlace(this.scene, next++),
      );
      this.points.set(
        group.id,
        places.filter((place) => place !== null),
      );
    }
  }

  /**
   * Repeats the query after a change of points or settings. `live` is true during a drag. If
   * `isEdit`, the change becomes a history entry.
   */
  changed(live: boolean, isEdit = !live): void {
    if (!this.bench.surface) return;
    this.scene.hold(live);
    if (live) this.handles.place();
    else this.showHandles();
    if (!live) this.tell();
    this.state.write(isEdit);
    if (live && !this.mode.followsDrag) return;
    this.bench.makeWay(live);
    this.asker.put(live);
  }

  private showWaiting(): void {
    if (!this.answer.showsProgress)
      this.answer.showProgress("Waiting for the answer", null, () => this.bench.cancel());
  }

  private showHandles(): void {
    byId("handles").hidden = !this.mode.showsPoints;
    this.handles.update();
  }

  private async ask(live: boolean): Promise<void> {
    const { bench, mode, points } = this;
    if (!bench.surface || bench.surface.kind !== mode.kind) return;
    const signal = bench.begin();
    if (!points.complete) return this.clearAnswer();
    const waiting = setTimeout(() => this.showWaiting(), PATIENCE);
    try {
      const { path } = bench.surface;
      if (!live) await points.map((place) => snapped(this.api, path, place, signal));
      await mode.ask(live);
      signal.throwIfAborted();
      if (live) this.rate.count();
    } catch (error) {
      if (!(live && isMiss(error))) this.refuse(signal.aborted ? signal.reason : error);
    }
    clearTimeout(waiting);
    if (bench.signal === signal) bench.end();
    if (!live) this.showHandles();
    this.tell();
  }

  /** Shows an error instead of the answer. */
  private refuse(error: unknown): void {
    if (isAbort(error)) return;
    this.mode.clear();
    this.bench.last = undefined;
    this.answer.clear();
    this.answer.warn(error, ...this.bench.remedies(error));
    this.onTrouble(messageOf(error));
    if (error instanceof ApiError && error.status === 404) void this.list(() => {});
  }

  /** Removes the answer, because points that the query needs are missing. */
  private clearAnswer(): void {
    this.mode.clear();
    this.answer.clear();
    this.tell();
  }

  // --- the rest of the page ----------------------------------------------------------------------

  private tell(): void {
    for (const watch of this.watchers) watch();
  }

  get busy(): boolean {
    return this.asker.busy || this.loads > 0 || this.uploads.busy || this.state.isPending;
  }

  /** Aborts the running query, the load and all uploads. */
  cancel(): void {
    this.bench.cancel();
    this.uploads.cancel();
    if (this.loads > 0) this.cancelLoad();
  }

  showFacts(): void {
    this.chooser.showFacts(this.bench.surface, this.units);
  }

  /**
   * Adds the surface point that a pixel shows, if any, to the active group. If `isOptional`, adds
   * the point to the optional group of the mode.
   */
  addAt(pixel: Pixel, isOptional = false): void {
    const place = this.scene.pick(pixel);
    if (place) this.points.add(place, isOptional ? this.points.optional : undefined);
  }

  /** Shows the answer again, in other units or colours. */
  reshow(): void {
    this.asker.put(false);
  }

  /** Writes a changed view to the address. */
  writeView(isEdit: boolean): void {
    if (this.bench.surface) this.state.write(isEdit);
  }

  undo(): void {
    this.state.undo();
  }

  redo(): void {
    this.state.redo();
  }

  /** Writes the address at once and returns it. */
  link(): string {
    this.state.flush();
    return location.href;
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
      ...(groups.length > 0 ? Object.fromEntries(groups) : { points: "none" }),
      ...this.mode.settings.read(),
      ...this.display.read(),
      ...(this.scene.up === "z" && { up: "z" }),
      camera: this.scene.view,
    };
  }
}
