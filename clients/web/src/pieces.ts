// Shows the pieces of a cut instead of the surface. Each piece has its own colour, and the pieces
// are moved apart.

import type { Bench } from "./bench.ts";
import { hexOf, memberColour } from "./colours.ts";
import { shaded } from "./creases.ts";
import { parsePly, type Triangles } from "./ply.ts";
import { Skin } from "./skin.ts";
import { surfacePath } from "./surface.ts";
import { scale, type Vec3 } from "./vector.ts";

/** Returns the mean of the triangles' corners. */
function middleOf(positions: Float32Array, faces: Uint32Array): Vec3 {
  const sum: Vec3 = [0, 0, 0];
  for (const vertex of faces)
    for (let axis = 0; axis < 3; axis++) sum[axis]! += positions[3 * vertex + axis]!;
  return scale(sum, 1 / faces.length);
}

export class Pieces {
  private skins: { skin: Skin; middle: Vec3 }[] = [];
  private key = "";

  constructor(private readonly bench: Bench) {}

  get areShown(): boolean {
    return this.skins.length > 0;
  }

  /** Returns whether the shown pieces are those of this cut. */
  isOf(key: string): boolean {
    return this.areShown && this.key === key;
  }

  /** Loads the meshes of the pieces and shows them instead of the surface. `key` names the cut. */
  async show(names: string[], key: string): Promise<void> {
    const all = await Promise.all(names.map((name) => this.fetch(name)));
    this.clear();
    this.key = key;
    this.skins = all.map((triangles, i) => this.add(triangles, i));
    const { scene } = this.bench;
    scene.skin!.mesh.visible = false;
    scene.lines.clear();
    scene.redraw();
  }

  private async fetch(name: string): Promise<Triangles> {
    const path = `${surfacePath("meshes", name)}/content`;
    const request = { method: "GET", path, query: { format: "ply" } } as const;
    return parsePly(await this.bench.api.bytes(request, this.bench.signal));
  }

  private add({ positions, faces }: Triangles, i: number): { skin: Skin; middle: Vec3 } {
    const view = this.bench.surface!.view(positions);
    const skin = new Skin({ positions: view, faces }, shaded(view, faces));
    skin.setColour(hexOf(memberColour(i)));
    this.bench.scene.solids.add(skin.mesh);
    return { skin, middle: middleOf(view, faces) };
  }

  /** Moves each piece away from the middle, by this fraction of its distance from the middle. */
  pull(part: number): void {
    for (const { skin, middle } of this.skins) skin.mesh.position.set(...scale(middle, part));
    if (this.skins.length > 0) this.bench.scene.redraw();
  }

  clear(): void {
    for (const { skin } of this.skins) {
      skin.mesh.removeFromParent();
      skin.dispose();
    }
    this.skins = [];
    const { skin } = this.bench.scene;
    if (skin) skin.mesh.visible = true;
    this.bench.scene.redraw();
  }
}
