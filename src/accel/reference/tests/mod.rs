mod answers;
mod judging;
mod kernels;
mod shapes;
