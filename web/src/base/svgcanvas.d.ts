// The part of svgcanvas that the page uses; the package has no types.
declare module "svgcanvas" {
  export class Context {
    constructor(options: { width: number; height: number; document: Document });
  }
}
