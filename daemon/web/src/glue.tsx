// glue
export default function Glue(_: { rest: string }) {
  return <h1>Glue</h1>;
}
