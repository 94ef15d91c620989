// What popcutd tells, as types. The generated description of its interface is the source; the server may leave out
// the members marked optional here.
import type { components } from './api';

type Schemas = components['schemas'];

export type Role = Schemas['Role'];
export type Warning = Schemas['Warning'];
export type Way = Schemas['Way'];
export type Ledger = Schemas['Ledger'];
export type Plan = Schemas['Plan'];
export type Search = Schemas['Search'];
export type SheetPlan = Schemas['SheetPlan'];
export type Sheet = Schemas['Sheet'];
export type Device = Schemas['Device'];
export type UsageRow = Schemas['UsageRow'];
export type SessionListed = Schemas['SessionListed'];

export type Job = Omit<Schemas['Job'], 'progress'> & {
  progress: Schemas['Job']['progress'] & { paths_done?: number };
  ways?: Way[];
  armed_until?: string | null;
  owner_title?: string | null;
  operator_title?: string | null;
  kind?: string;
};

export type Meta = Omit<Schemas['Meta'], 'principal'> & {
  now?: string;
  page?: string;
  principal: { name: string; role: Role; title?: string };
};

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

export interface ProblemEntry { pointer: string; code: string; detail: string }

const ranks: Record<Role, number> = { viewer: 0, submitter: 1, operator: 2, admin: 3 };

/** Whether `role` includes all that `least` may do. */
export function includes(role: Role, least: Role): boolean {
  return ranks[role] >= ranks[least];
}
