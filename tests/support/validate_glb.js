// Asks the Khronos validator (npm gltf-validator, found in the folder given first) about GLB files
// and prints what it says as JSON, a list with an entry a file.
const fs = require('fs');
const path = require('path');

const [folder, ...files] = process.argv.slice(2);
const validator = require(path.join(folder, 'node_modules', 'gltf-validator'));

Promise.all(files.map((file) => validator.validateBytes(new Uint8Array(fs.readFileSync(file)))))
    .then((reports) => {
      console.log(JSON.stringify(reports.map((report) => ({issues: report.issues, info: report.info}))));
    })
    .catch((fault) => {
      console.error(String(fault));
      process.exit(1);
    });
