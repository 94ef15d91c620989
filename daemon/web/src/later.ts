// SPDX-License-Identifier: MIT
// The views that are loaded when one of them is first shown: together, since they share most of what they are made of.
import Design from './design';
import Fold from './fold';
import Glue from './glue';
import Settings from './settings';
import Sheets from './sheets';

export const views = { design: Design, fold: Fold, glue: Glue, settings: Settings, sheets: Sheets };
