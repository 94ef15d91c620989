// SPDX-License-Identifier: MIT
// The frames that the engine speaks, as in daemon/planning/frames.hpp.
export const Kind = { task: 1, design: 2, asset: 3, go: 4, file: 5, outcome: 6, failure: 7, phase: 8 } as const;

/** PlanningTask::Kind of daemon/planning/planner.hpp, in its order. */
const kTasks = ['check', 'plan', 'testCut', 'preview', 'lattice', 'picture', 'export', 'place', 'artwork', 'svg', 'make', 'search'] as const;
export type TaskKind = (typeof kTasks)[number];

export type Bytes = Uint8Array<ArrayBuffer>;

export interface Frame { kind: number; name: string; bytes: Bytes }

export interface Task {
  kind: TaskKind;
  design: Bytes;
  designKind?: string;
  machine?: string;    // rows of the tables, JSON
  material?: string;
  options?: Record<string, string>;
  assets?: ReadonlyMap<string, Bytes>;
}

const kHead = 20;
const utf8 = new TextEncoder();

function frame(kind: number, name: string, bytes: Bytes): Bytes[] {
  const word = utf8.encode(name);
  const head = new Uint8Array(kHead + word.length);
  const view = new DataView(head.buffer);
  head.set(utf8.encode('PCW1'));
  view.setUint32(4, kind, true);
  view.setUint32(8, word.length, true);
  view.setBigUint64(12, BigInt(bytes.length), true);
  head.set(word, kHead);
  return [head, bytes];
}

/** A task as the engine reads it. */
export function framesOf(task: Task): Bytes {
  const about = {
    kind: kTasks.indexOf(task.kind), design_kind: task.designKind ?? '', machine: task.machine ?? '', material: task.material ?? '', profile: '',
    options: task.options ?? {},
  };
  const parts = [
    ...frame(Kind.task, '', utf8.encode(JSON.stringify(about))), ...frame(Kind.design, '', task.design),
    ...[...task.assets ?? []].flatMap(([id, bytes]) => frame(Kind.asset, id, bytes)), ...frame(Kind.go, '', new Uint8Array()),
  ];
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}
