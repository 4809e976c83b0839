//! The programs that come with the control, each ground on its part to size on the simulated machine: rows K7.9, K7.10,
//! K4.1–K4.5, P4–P7.

mod batch;
mod bore;
mod dressing;
mod feeds;
mod gauge;
mod measured;
mod pages;
mod post_process;
mod refusals;
mod retract;
mod seats;
mod set_up;
mod shop;
mod sizes;
mod wheel_wear;
