// The members of kustomize's files that docker/ uses. kustomize publishes no types.

interface Common {
  resources?: string[];
  components?: string[];
  configMapGenerator?: { name: string; files?: string[]; literals?: string[] }[];
  images?: { name: string; newName?: string; newTag?: string; digest?: string }[];
}

export interface Kustomization extends Common {
  apiVersion: "kustomize.config.k8s.io/v1beta1";
  kind: "Kustomization";
}

export interface Component extends Common {
  apiVersion: "kustomize.config.k8s.io/v1alpha1";
  kind: "Component";
}
