// Every text of the page, once, and how it writes numbers, lengths and times.
import { language, units } from './preferences';

type Text = string | ((...values: never[]) => string);
export interface Texts { [name: string]: Text | Texts }

const pseudoLetters: Record<string, string> = {
  a: 'á', e: 'é', i: 'í', o: 'ó', u: 'ú', A: 'Á', E: 'É', I: 'Í', O: 'Ó', U: 'Ú', n: 'ñ', c: 'ç', y: 'ý',
};

/** `text` with accents, brackets and 40 % more length: shows texts that do not go through here, and what is cut off. */
function pseudo(text: string): string {
  if (text === '') return text;
  const longer = '~'.repeat(Math.ceil(text.length * 0.4));
  return `[${text.replace(/[aeiouAEIOUncy]/g, (letter) => pseudoLetters[letter] ?? letter)}${longer}]`;
}

/** `texts` in the language that this browser prefers. */
export function localized<T extends Texts>(texts: T): T {
  if (language.peek() !== 'pseudo') return texts;
  const other = (text: Text | Texts): Text | Texts => {
    if (typeof text === 'string') return pseudo(text);
    if (typeof text === 'function') return (...values: never[]) => pseudo(text(...values));
    return Object.fromEntries(Object.entries(text).map(([name, inner]) => [name, other(inner)]));
  };
  return other(texts) as T;
}

const whole = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });
const oneDigit = new Intl.NumberFormat('en', { maximumFractionDigits: 1 });
const twoDigits = new Intl.NumberFormat('en', { maximumFractionDigits: 2 });
const timeOfDay = new Intl.DateTimeFormat('en-GB', { hour: '2-digit', minute: '2-digit' });
const timeToSecond = new Intl.DateTimeFormat('en-GB', { hour: '2-digit', minute: '2-digit', second: '2-digit' });
const dayAndTime = new Intl.DateTimeFormat('en-GB', {
  day: 'numeric', month: 'short', hour: '2-digit', minute: '2-digit',
});
const plural = new Intl.PluralRules('en');
const listed = new Intl.ListFormat('en', { type: 'conjunction' });

export const integer = (value: number): string => whole.format(value);
export const percent = (share: number): string => `${whole.format(Math.floor(share * 100))} %`;
export const joined = (items: string[]): string => listed.format(items);

/** `mm` in the units of this browser, with the unit: "169 mm", "6.65 in". */
export function length(mm: number): string {
  return units.value === 'inch' ? `${twoDigits.format(mm / 25.4)} in` : `${oneDigit.format(mm)} mm`;
}

/** A size, "169 × 125 mm". */
export function size(width_mm: number, length_mm: number): string {
  const inch = units.value === 'inch';
  const one = (mm: number): string => (inch ? twoDigits.format(mm / 25.4) : oneDigit.format(mm));
  return `${one(width_mm)} × ${one(length_mm)} ${inch ? 'in' : 'mm'}`;
}

/** A long length of cutting, "12.3 m". */
export const metres = (mm: number): string => (units.value === 'inch'
  ? `${whole.format(mm / 304.8)} ft` : `${oneDigit.format(mm / 1000)} m`);

/** "0:41", "1:02:03". */
export function clockTime(seconds: number): string {
  const all = Math.max(0, Math.round(seconds));
  const two = (n: number): string => String(n).padStart(2, '0');
  const hours = Math.floor(all / 3600);
  const minutes = Math.floor(all / 60) % 60;
  return hours > 0 ? `${hours}:${two(minutes)}:${two(all % 60)}` : `${minutes}:${two(all % 60)}`;
}

/** A sentence of popcutd without the ticks that mark words to type on a command line. */
export const withoutTicks = (text: string): string => text.replace(/`/g, '');

/** A range of seconds, "3:00–4:04", or one time when both ends look the same. */
export function timeRange([least, most]: readonly number[]): string {
  const low = clockTime(least ?? 0);
  const high = clockTime(most ?? least ?? 0);
  return low === high ? low : `${low}–${high}`;
}

/** A rough duration, "40 s", "22 min", "1 h 5 min". */
export function duration(seconds: number): string {
  if (seconds < 60) return `${whole.format(Math.max(0, seconds))} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** How long something takes, in words: "under a minute", "about 20 minutes". */
export const minutes = (seconds: number): string => {
  const n = Math.round(seconds / 60);
  return seconds < 60 ? 'under a minute' : `about ${whole.format(n)} ${plural.select(n) === 'one' ? 'minute' : 'minutes'}`;
};

export const hourMinute = (at: number | string): string => timeOfDay.format(new Date(at));
export const hourMinuteSecond = (at: number | string): string => timeToSecond.format(new Date(at));
export const dateTime = (at: number | string): string => dayAndTime.format(new Date(at));

/** "1 sheet", "3 sheets". */
export const count = (n: number, one: string, many: string): string =>
  `${whole.format(n)} ${plural.select(n) === 'one' ? one : many}`;

const sheets = (n: number): string => count(n, 'sheet', 'sheets');
const strokes = (n: number): string => count(n, 'stroke', 'strokes');

export const words = localized({
  title: 'popcut',
  views: { now: 'Now', design: 'Design', done: 'Done', settings: 'Settings', main: 'Views', skip: 'Skip to the content' },
  roles: { viewer: 'viewer', submitter: 'submitter', operator: 'operator', admin: 'admin' } as Record<string, string>,
  person: (name: string, role: string) => `${name}, ${role}`,
  sheets,
  strokes,
  copies: (n: number) => count(n, 'copy', 'copies'),
  /** What a card is to fold: its folds, the shortest of them, the seconds, and how hard that is. */
  byHand: (folds: number, shortest_mm: number, seconds: number, label: string) => (folds === 0 ? 'nothing to fold'
    : `${count(folds, 'fold', 'folds')}, the shortest ${length(shortest_mm)}; ${minutes(seconds)} to fold${label === '' ? '' : ` (${label})`}`),
  toFold: (seconds: number, label: string) => `${minutes(seconds)} to fold${label === '' ? '' : ` (${label})`}`,
  close: 'Close',
  back: 'Back',
  cancelled: 'Cancel',
  loading: 'Loading…',
  unnamed: 'Untitled',
  nobody: 'nobody',
  notFound: 'There is no such page here.',
  toNow: 'Go to Now',
  moreActs: (name: string) => `More for ${name}`,

  live: {
    connecting: 'connecting…',
    live: 'live',
    stale: (at: string) => `as of ${at}`,
    staleLong: (at: string) => `popcutd does not answer since ${at}. Is it running? "popcut open" starts it.`,
    again: 'Try now',
    updated: 'popcutd was updated.',
    newer: 'A newer version of this page is ready.',
    unkept: {
      full: 'This browser has no room left, so what you make now is kept only until you close this tab. Save it as files, or delete what you no longer need in Settings.',
      forbidden: 'This browser keeps nothing for this page (its settings or a private window forbid it), so what you make is gone when you close this tab. Save it as files.',
    },
    reload: 'Reload the page',
    waiting: (seconds: string) => `popcutd asks to wait ${seconds} s; this repeats by itself.`,
    device: (title: string) => `${title}:`,
  },

  states: {
    queued: 'queued', planning: 'planning', ready: 'ready', armed: 'armed', cutting: 'cutting', paused: 'paused',
    interrupted: 'interrupted', done: 'done', failed: 'failed', cancelled: 'cancelled', held: 'held',
    pausing: 'pausing',
  } as Record<string, string>,
  deviceStates: {
    absent: 'away', offline: 'offline', idle: 'free', busy: 'busy', attention: 'needs you', fault: 'fault',
  } as Record<string, string>,
  phases: {
    connecting: 'connecting', settings: 'settings', searching: 'looking for the marks', cutting: 'cutting',
    finishing: 'finishing', parking: 'feeding out', held: 'held', paused: 'paused',
  } as Record<string, string>,
  planPhases: {
    reading: 'reading the design', slicing: 'cutting the shape into slices', lattice: 'laying the lattice',
    checking: 'checking the pattern', cleaning: 'cleaning the lines', splitting: 'splitting it into sheets',
    toolpath: 'making the strokes', writing: 'writing the programs',
  } as Record<string, string>,
  reasons: {
    device_gone: 'The connection to the cutter broke.',
    stall: 'The cutter took no more data.',
    media_out: 'The sheet came out.',
    panel_stop: 'It was stopped at the panel of the cutter.',
    marks_not_found: 'The cutter did not find the printed marks.',
    refused: 'The cutter refused a command.',
    unconfirmed: 'The cutter does not report. Look at the sheet.',
    result_bad: 'You said that the sheet is not good.',
    shutdown: 'popcutd was stopped.',
    crash: 'popcutd or its computer stopped suddenly.',
    store: 'The disk of popcutd failed.',
    error: 'Something went wrong.',
  } as Record<string, string>,
  attentions: {
    load_sheet: (sheet: number, total: number, material: string, device: string) => `Load sheet ${sheet} of ${total}, ${material}, on ${device}`,
    device_absent: (device: string) => `Plug in ${device} and switch it on`,
    device_busy: (device: string) => `${device} takes no data: look for a jam, or a question on its panel`,
    device_fault: (device: string) => `${device} has a fault: see to it there`,
    media_out: () => 'The sheet came out: decide how to go on',
    in_doubt: (share: string) => `Stopped at ${share}: look at the sheet`,
    confirm_result: () => 'Look at the sheet: did it come out well?',
  },

  now: {
    cutters: 'Cutters',
    waiting: 'Waiting for you',
    cutting: 'Being cut',
    next: 'Next',
    nextSum: (jobs: number, time: string, toLoad: number) => `${count(jobs, 'job', 'jobs')}, ${time} of cutting, ${sheets(toLoad)} to load`,
    nextSumUntil: (jobs: number, time: string, toLoad: number, until: string) => `${count(jobs, 'job', 'jobs')}, ${time} of cutting until about ${until}, ${sheets(toLoad)} to load`,
    done: 'Done',
    all: 'All that is done',
    what: 'popcut turns a shape into a card that pops up, and cuts it.',
    empty: 'Nothing to cut.',
    open: 'Open a file',
    emptyWhat: 'Or start from one of these.',
    noDevice: 'No cutter is connected.',
    noDeviceWhat: 'Plug one in and switch it on. "popcut doctor" on the computer of popcutd says what it sees and what is missing.',
    goToMachine: 'Go to machine',
    lookAtIt: 'Look at it',
    watch: 'Watch',
    armed: (who: string) => `Armed by ${who}: START waits at the machine`,
    sheetOf: (k: number, n: number) => `sheet ${k} of ${n}`,
    left: (range: string) => `${range} left`,
    until: (time: string) => `until ${time}`,
    freeNow: 'free',
    busyName: (state: string, name: string, k: number, n: number) => `${state} "${name}", sheet ${k} of ${n}`,
    hold: 'Hold back',
    release: 'Release',
    first: 'Move to the front',
    cancel: 'Cancel this job',
    otherCutter: 'Another cutter',
    otherCutterWhat: 'popcutd plans the sheets anew for it, with the same options. Nothing is cut before you arm and start.',
    planAgain: 'Plan it for this one',
    cutter: 'Cutter',
    cancelSure: (name: string) => `Cancel "${name}"? What is cut stays cut.`,
    plan: 'Show the sheets',
    failedWhy: 'Planning failed',
    disabled: 'switched off in popcutd',
    simulated: 'simulated',
    atNode: (node: string) => `at ${node}`,
    testCut: 'test cut',
    more: (n: number) => `and ${n} more`,
  },

  examples: { cards: 'Cards', paper: 'From the paper' },

  machine: {
    noDevice: 'There is no such cutter.',
    elsewhere: (device: string, node: string) => `${device} is at ${node}, another popcutd.`,
    elsewhereWhat: 'Arm, start and go on there. You can pause it from here.',
    goThere: (node: string) => `Go to ${node}`,
    nothing: (device: string) => `Nothing waits for ${device}.`,
    nothingWhat: 'Queue a design, or let the cutter make a test cut.',
    testCut: 'Test cut',
    testCutWhat: 'A small square and a triangle that show whether the blade depth is right.',
    testCutMaterial: 'Material',
    testCutGo: 'Queue a test cut',
    otherJobs: 'Other jobs for this cutter',
    danger: 'In danger, use the machine\u2019s own switch.',
    feedEdge: 'feed edge: this side goes in first',
    picture: (k: number, name: string, w: string) => `Sheet ${k} of "${name}" as it lies on the mat, ${w}`,
    trueSize: (drawing: string, x: string, y: string) => `${drawing}, placed at ${x}, ${y}`,
    ready: 'Ready',
    loadSheet: (k: number, n: number) => `Load sheet ${k} of ${n}`,
    blank: (n: number) => `Blank ${n}: take a new sheet.`,
    keepSheet: 'Leave the sheet where it is: it goes on.',
    loadAgain: 'Load the same sheet again, in the same place.',
    tickMaterial: (material: string, side: string) => (side ? `${material}, ${side}` : material),
    sides: { 'pop-up': 'the side that pops up is up', printed: 'printed side up', drawn: 'drawn side up' } as Record<string, string>,
    onMat: (mat: string) => `lies on the mat (${mat})`,
    noMat: (sheetSize: string) => `lies in the cutter, at least ${sheetSize}`,
    tickMat: 'Mat is fed to the line',
    tickSheet: 'Sheet is fed to the line',
    tickBlade: (blade: string) => `Blade: ${blade}`,
    bladeDepth: (depth: string) => `depth ${depth}`,
    bladeForce: (force: string) => `force ${force}`,
    tickBladeAny: 'Blade is in, at the depth for this material',
    warnings: 'Read this first',
    spoils: 'This may spoil the cut.',
    accept: 'I have read it. Cut all the same.',
    hints: 'Good to know',
    arm: 'Arm',
    armWhat: 'Arming moves nothing.',
    afterFault: 'The cutter is not ready.',
    afterTicks: 'Tick all three first.',
    afterWarnings: 'Accept the warning first.',
    notBeside: (device: string) => `Are you at the ${device}?`,
    notBesideWhat: (device: string) => `Settings do not name this screen as the one beside it. Somebody\u2019s hands may be in ${device}. Arm only if you see it.`,
    notBesideGo: 'I see the cutter: arm',
    armed: 'Armed',
    armedWhat: 'Hands off. Hold START to cut.',
    armedBy: (who: string) => `Armed by ${who}.`,
    lapses: (left: string) => `armed for ${left} more`,
    lapsesSoon: 'lapses after ten minutes',
    start: 'START',
    holdTo: 'hold to',
    startSure: 'Start to cut?',
    startSureWhat: (k: number, n: number, device: string) => `The knife of ${device} moves at once: sheet ${k} of ${n}.`,
    startGo: 'Start the cut',
    disarm: 'Disarm',
    sending: 'Sending…',
    cutting: 'Cutting',
    pausing: 'Pausing',
    pausingWhat: 'It stops at the end of the stroke, with the tool up.',
    paused: 'Paused',
    pausedWhat: 'The tool is up. Nothing moves.',
    goOn: 'GO ON',
    goOnSure: 'Go on cutting?',
    goOnSureWhat: (device: string) => `The knife of ${device} moves at once.`,
    goOnGo: 'Go on cutting',
    endJob: 'End the job',
    endJobSure: (name: string) => `End "${name}"?`,
    endJobWhat: 'What is cut stays cut. The job cannot be taken up again.',
    endJobGo: 'End it',
    cancelJob: 'Cancel job',
    cancelJobSure: (name: string) => `Cancel "${name}"?`,
    cancelJobWhat: 'What is cut stays cut. The job cannot be taken up again.',
    cancelJobGo: 'Cancel the job',
    skipSheet: 'Skip this sheet',
    skipSheetSure: (k: number) => `Skip sheet ${k}?`,
    skipSheetWhat: 'It will be missing from this copy.',
    skipSheetGo: 'Skip it',
    newSheet: 'Take a new sheet',
    progress: (done: number, total: number) => `${integer(done)} of ${strokes(total)}`,
    likely: 'Thick: certainly cut. Outlined: sent, probably cut. Pale: still to come.',
    left: (range: string) => `${range} left`,
    mayNot: 'An operator may arm and start it.',
    mayNotPause: 'An operator may pause it.',
    legend: 'Cuts solid, mountain folds dash-dot, valley folds dashed.',
    order: 'Order of the strokes',
    fault: 'The cutter needs you',
    reset: 'It is seen to: reset',
    planFailed: 'It cannot be cut like this.',
    removed: (who: string) => `This job was removed by ${who}.`,
    howToFold: 'How to fold it',
    holdOn: 'Keep holding, until the ring is full.',
    finishedWhat: (name: string) => `"${name}" is cut. Take the sheet out.`,
    endedWhat: (name: string, state: string) => `"${name}": ${state}.`,
    awake: 'This screen stays awake.',
    whatIsCut: 'Job',
    time: 'Time',
    loadedAs: 'Sheet',
  },

  changed: {
    nothingDone: 'Nothing was done.',
    itChanged: 'It changed in the meantime.',
    by: (who: string, what: string, ago: string) => `${who} ${what} ${ago} ago.`,
    someone: 'Somebody',
    meanwhile: (state: string) => `It is ${state} now.`,
    did: {
      armed: 'armed it', cutting: 'started it', paused: 'paused it', ready: 'changed it', cancelled: 'cancelled it',
      interrupted: 'stopped it', done: 'finished it',
    } as Record<string, string>,
    changedIt: 'changed it',
  },

  pause: {
    pause: 'PAUSE',
    what: 'at the end of the stroke, tool up',
    pausing: 'PAUSING',
    paused: 'PAUSED',
    notSent: 'NOT SENT',
    notSentWhat: 'Use the switch of the machine.',
    still: 'Still trying.',
    through: (seconds: string) => `It got through after ${seconds} s.`,
    refused: 'Not paused.',
    goThere: 'Go to machine',
    of: (device: string, name: string) => `${device}, "${name}"`,
  },

  interrupted: {
    title: 'Interrupted',
    look: 'Look at the sheet.',
    certain: (n: number) => `${integer(n)} certain`,
    doubt: (n: number) => `${integer(n)} in doubt`,
    notCut: (n: number) => `${integer(n)} not cut`,
    why: (reason: string, time: string) => `${time}: ${reason}`,
    lens: (what: string, i: number, n: number) => `${what} ${integer(i)} of ${integer(n)}`,
    lensTitle: 'At true size',
    first: 'First in doubt',
    previous: 'One stroke back',
    next: 'One stroke on',
    replay: 'Play what was done',
    replayStop: 'Stop',
    replayAt: 'Time of the cut',
    choose: 'What do you want?',
    newSheet: 'New sheet',
    newSheetWhat: (n: number) => `Take a new sheet. All ${strokes(n)} are cut on it. Paper is cheap: this is the safe way.`,
    goOn: 'Go on from a stroke',
    goOnWhat: 'Tap the first stroke to cut on the picture.',
    goOnFrom: (what: string) => `From ${what}.`,
    goOnCuts: (n: number) => `It cuts ${strokes(n)}.`,
    kept: 'The sheet has not moved',
    reRegistered: 'I load it again, in the same place',
    twice: (n: number) => `${strokes(n)} may be cut twice.`,
    uncut: (n: number) => `${strokes(n)} may stay uncut.`,
    tickTwice: (n: number) => `I accept that ${strokes(n)} may be cut twice.`,
    tickUncut: (n: number) => `I accept that ${strokes(n)} may stay uncut.`,
    whole: 'It is whole',
    wholeNot: (n: number) => `It cannot be: ${strokes(n)} ${n === 1 ? 'was' : 'were'} never sent.`,
    wholeWhat: 'You looked: every stroke is cut. The sheet counts as done.',
    notGood: 'It is not good',
    notGoodWhat: 'Then take a new sheet, or skip this one.',
    skip: 'Skip this sheet',
    skipWhat: 'It will be missing from this copy; the job goes on with the next sheet.',
    giveUp: 'Give up',
    giveUpWhat: 'The job ends. What is cut stays cut.',
    go: 'That is what I want',
    noneStarts: 'None of these starts the cutter.',
    chooseFirst: 'Choose one first.',
    tickFirst: 'Tick what it may do.',
    sameBlankOnly: 'The sheet as it is: tap a stroke to see it.',
    noLedger: 'The record of this sheet cannot be read.',
    kinds: {
      cut: 'cut', outline: 'cut', mountain: 'mountain fold', valley: 'valley fold', score: 'score', draw: 'drawn line', mark: 'mark',
      label: 'letter', tab: 'tab', fold: 'fold', slit: 'slit',
    } as Record<string, string>,
    stroke: 'stroke',
  },

  done: {
    title: 'Done',
    empty: 'Nothing was cut yet.',
    more: 'Older ones',
    usage: 'Usage',
    by: 'By',
    byOwner: 'person', byDevice: 'cutter', byMaterial: 'material',
    columns: { key: 'Name', time: 'Time', cut: 'Cut', sheets: 'Sheets' },
    csv: 'Save as CSV',
    csvName: 'popcut-usage.csv',
    again: 'Cut it again',
    finished: (when: string) => `finished ${when}`,
    jobs: 'Jobs',
    total: 'All',
    remove: 'Remove',
  },

  settings: {
    title: 'Settings',
    display: 'Display',
    units: 'Lengths in', mm: 'millimetres', inch: 'inches',
    theme: 'Colours', system: 'as the system', light: 'light', dark: 'dark',
    language: 'Language', english: 'English', pseudo: 'Pseudo (for tests)',
    beside: 'This screen stands beside', besideNone: 'no cutter',
    besideWhat: 'Beside a cutter, Arm does not ask whether you see it.',
    tablets: 'Tablets and other screens',
    allowWhat: 'Open this page on the tablet. It shows a code of six letters; type it here.',
    code: 'Code', role: 'May act as', allow: 'Allow',
    allowed: (name: string, role: string) => `"${name}" is signed in as ${role}.`,
    sessions: 'Signed in',
    thisOne: 'this screen',
    session: (role: string, since: string) => `${role}, since ${since}`,
    ends: (when: string) => `ends ${when} if unused`,
    end: 'Sign out',
    endThis: 'Sign out here',
    about: 'About',
    build: (build: string) => `popcutd ${build}`,
    licences: 'Licences of what this page is made of',
    schema: 'The HTTP interface (OpenAPI)',
    keys: 'Keys',
    keyHelp: 'shows the keys',
    keyPause: 'pauses what is being cut',
    keyNow: 'goes to Now',
    keyDesign: 'goes to Design',
    keyDone: 'goes to Done',
    keySettings: 'goes to Settings',
    server: 'Server',
    person: 'You',
  },

  signIn: {
    title: 'Sign in',
    what: 'On the computer of popcutd, run "popcut open". On any other screen, let somebody who is signed in allow it with a code.',
    name: 'Name of this screen',
    defaultName: (kind: string) => `${kind}`,
    tablet: 'Tablet', phone: 'Phone', computer: 'Computer',
    get: 'Show a code',
    codeWhat: 'On a screen that is signed in: Settings, Tablets. Type this code there.',
    code: 'Your code',
    waits: (left: string) => `Waiting. The code is good for ${left}.`,
    lapsed: 'The code has lapsed.',
    again: 'Show another code',
    over: 'Your session is over.',
    overWhat: 'What you see is as of then. Your drafts are kept.',
    signAgain: 'Sign in again',
    other: 'Sign in as somebody else?',
    otherWhat: 'You are signed in here. This link opens another session, which may be that of whoever sent it.',
    stay: 'Stay signed in',
    change: 'Use the link',
    bad: 'This link was used already, or it is older than a minute. Run "popcut open" again.',
  },

  problems: {
    unreachable: 'popcutd does not answer.',
    unauthenticated: 'You are not signed in.',
    forbidden: 'You may not do this. An operator may.',
    'not-found': 'This is gone.',
    'state-conflict': 'That is not possible now.',
    'device-absent': 'The cutter is not connected.',
    stale: 'It changed in the meantime. Nothing was done.',
    rate: 'Too many requests.',
    'queue-full': 'The queue is full.',
    unavailable: 'popcutd is busy.',
    'disk-full': 'The disk of popcutd is full.',
    'too-large': 'That is too large.',
    validation: 'Something in it is not right.',
    internal: 'popcutd has a bug. Please report it with this number.',
    other: 'It did not work.',
  } as Record<string, string>,
  request: (id: string) => `Request ${id}`,
  tooLarge: (limit: string) => `The file is larger than ${limit}.`,
});
