// What emscripten makes of daemon/site/engine.cpp.
declare module 'engine' {
  const popcutEngine: (options: Record<string, unknown>) => Promise<unknown>;
  export default popcutEngine;
}
