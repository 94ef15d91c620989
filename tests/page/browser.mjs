// The browser that all tests of a run share: run.mjs browser.mjs FILE starts it, writes its address into FILE, and ends
// it on SIGTERM. tests/support/beside starts and ends this program.
import { once } from 'node:events';
import { renameSync, writeFileSync } from 'node:fs';
import { chromium } from 'playwright-core';
import { launchOptions } from './harness.mjs';

const file = process.argv.at(-1);
const ended = once(process, 'SIGTERM');
const server = await chromium.launchServer(launchOptions);
writeFileSync(`${file}.new`, server.wsEndpoint());
renameSync(`${file}.new`, file);
await ended;
await server.close();
