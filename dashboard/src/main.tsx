// Start the page: theme, router, connection, then the first drawing.
import "uplot/dist/uPlot.min.css";
import "./styles/index.css";
import { render } from "preact";
import { startRouter } from "./browser/router";
import { startTheme } from "./browser/theme";
import { connect } from "./data/connection";
import { loadCurrentUser } from "./data/session";
import { Shell } from "./shell/shell";

startTheme();
startRouter();
connect();
void loadCurrentUser();
const page = document.getElementById("page")!;
page.replaceChildren();
render(<Shell />, page);
