// What popcutd answers, as types. All but the event are generated from its description (daemon/http/api/openapi.json).
import type { components } from './api';

type Schemas = components['schemas'];

export type Role = Schemas['Role'];
export type Warning = Schemas['Warning'];
export type Way = Schemas['Way'];
export type Ledger = Schemas['Ledger'];
export type Plan = Schemas['Plan'];
export type Search = Schemas['Search'];
export type Machine = Schemas['Machine'];
export type SheetPlan = Schemas['SheetPlan'];
export type Sheet = Schemas['Sheet'];
export type Strokes = Schemas['Strokes'];
export type Device = Schemas['Device'];
export type Design = Schemas['Design'];
export type Example = Schemas['Example'];
export type UsageRow = Schemas['UsageRow'];
export type SessionListed = Schemas['SessionListed'];
export type Job = Schemas['Job'];
/** What there is to ask for. Only popcutd can queue; keep: this browser keeps designs in place of popcutd. */
export type Ability = Schemas['Meta']['can'][number] | 'keep';
export type Meta = Omit<Schemas['Meta'], 'can'> & { can: Ability[] };
export type ProblemEntry = NonNullable<Schemas['Problem']['errors']>[number];

/** What a `progress` event says about the cut of a job; of one that is planned, only `phase` and `share`. */
export interface Progress {
  sheet: number;
  phase: string;
  paths: number;
  paths_certain: number;
  paths_sent: number;
  paths_done: number;
  remaining_s?: [number, number];
  seconds_left?: number;
  share?: number | null;
}

const ranks: Record<Role, number> = { viewer: 0, submitter: 1, operator: 2, admin: 3 };

/** Whether `role` includes all that `least` may do. */
export function includes(role: Role, least: Role): boolean {
  return ranks[role] >= ranks[least];
}
