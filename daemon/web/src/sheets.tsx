// sheets
export default function Sheets(_: { rest: string }) {
  return <h1>Sheets</h1>;
}
